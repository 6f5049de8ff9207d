/* Winches of a soft robot on an Arduino Uno or Mega. How it talks: docs/decisions/0037-firmware.md.

   Time is counted in ticks of 4 ms, places in counts of an encoder, or in microseconds of a servo's pulse.
   Four things stop a motor here: silence for DEADLINE_MS, too much current, no motion under full power, and the
   hardware watchdog, which resets the processor 120 ms after the control loop ran last: pins are inputs then, and
   pull-down resistors switch the bridges off. */

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <util/atomic.h>
#include <util/crc16.h>

#ifndef ROBOT /* other settings may come by -include */
#include "settings.h"
#endif

#include "board.h"

#define COUNT (DCS + SERVOS)
#define RATE 250 /* ticks a second */
#define BAUD_RATE 250000UL
#define LONGEST 240 /* bytes of a line */
#define HALF 12     /* ticks after which a line that came to a halt is thrown away */

/* Power of 255 by counts of error, of error summed over ticks, and of error of speed a tick. */
#define GAIN_P 1.8f
#define GAIN_I 0.02f
#define GAIN_D 6.5f
#define GAIN_BOUND 120.0f
#ifndef SPIN_UP_MS
#define SPIN_UP_MS 20 /* in which a motor without load comes to two thirds of its speed */
#endif
#define BEYOND_BY 100 /* counts past a limit at which something is wrong */
#define SENSE 11      /* volts at the driver's current pin, by amperes, times ten */

#if DEADLINE_MS > 250 || DEADLINE_MS < 20
#error "the deadline is from 20 to 250 ms"
#endif
#if SERVOS > 8 || COUNT < 1
#error "from one motor to as many as the board bears, with at most 8 servos"
#endif

typedef struct {
    int32_t low, high;
    float speed, rise;
    int8_t sign;
    uint16_t current;
} Limits;

typedef struct {
    float aim, wish, pace, gain, most, sum; /* goal, place on the way, its speed, its gain, the greatest [1/tick], integral */
    int32_t before;                   /* place a tick ago */
    uint16_t bound, milliamps;
    int16_t power;      /* of 255, of the last tick */
    int8_t pace_seen;   /* counts in the last tick */
    uint8_t pays;       /* whether the current pays cable out: its driver tells only how much */
    uint8_t hot, stuck; /* ticks of too much current, of full power without motion */
} Motor;

enum State { OFF, ARMED, SILENT, CURRENT, STALL, ENCODER, BEYOND };
static const char *const words[] = {"off", "armed", "silent", "current", "stall", "encoder", "beyond"};

static const Limits limits[COUNT] = MOTORS;
static Motor motors[COUNT];
static volatile int32_t places[COUNT]; /* of encoders */
static volatile uint8_t lost;          /* an encoder made a step that it cannot make */
static enum State state = OFF;
static uint8_t culprit;
static uint8_t silence; /* ticks since a good line */
static volatile uint8_t ticks;
static uint8_t cause __attribute__((section(".noinit")));
static uint8_t marked; /* zeros were found since the power came on: 0 after each start */
static uint8_t zeroed; /* whether the board itself knows them, and no encoder was lost since */
static uint8_t alone;  /* whether moves play without a computer, see moves.h */

/* The watchdog still runs after it has reset the processor: it is switched off before anything else. */
void begin(void) __attribute__((naked, used, section(".init3")));
void begin(void) {
    cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
}

/* ---- serial line ---- */

static volatile uint8_t in[128], in_head, in_tail, out_head, out_tail;
static volatile uint8_t out[256];
static uint16_t sum;

ISR(LINE_IN) {
    uint8_t next = (in_head + 1) & 127, byte = UDR0;
    if (next != in_tail) {
        in[in_head] = byte;
        in_head = next;
    }
}

ISR(LINE_OUT) {
    if (out_head == out_tail)
        UCSR0B &= ~(1 << UDRIE0);
    else
        UDR0 = out[out_tail++];
}

static void put(char c) {
    while ((uint8_t)(out_head + 1) == out_tail)
        ; /* the watchdog bounds this wait */
    out[out_head] = c;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        out_head++;
        UCSR0B |= 1 << UDRIE0;
    }
    sum = _crc16_update(sum, c);
}

static void say(const char *text) {
    while (*text)
        put(*text++);
}

static void say_number(int32_t number) {
    char text[12];
    put(' ');
    say(ltoa(number, text, 10));
}

static void end_line(void) {
    char text[7];
    uint16_t check = sum;
    for (uint8_t i = 0; i < 4; i++, check <<= 4)
        text[i] = "0123456789ABCDEF"[check >> 12];
    text[4] = '\n';
    text[5] = 0;
    put('*');
    say(text);
    sum = 0xFFFF;
}

/* ---- motors ---- */

static inline void count(uint8_t pins, uint8_t *old, uint8_t motor, uint8_t shift) {
    static const int8_t steps[16] = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};
    uint8_t now = pins >> shift & 3, was = *old >> shift & 3;
    int8_t step = steps[was << 2 | now];
    if (step == 2)
        lost = motor + 1;
    else
        places[motor] += limits[motor].sign > 0 ? step : -step;
}

static uint8_t old_first, old_second;
#if DCS
ISR(FIRST_vect) {
    uint8_t pins = FIRST_PINS;
    for (uint8_t i = 0; i < DCS && i < FIRST_BRIDGES; i++)
        count(pins, &old_first, i, bridges[i].channel);
    old_first = pins;
}
#endif
#if DCS > FIRST_BRIDGES
ISR(SECOND_vect) {
    uint8_t pins = SECOND_PINS;
    for (uint8_t i = FIRST_BRIDGES; i < DCS; i++)
        count(pins, &old_second, i, bridges[i].channel);
    old_second = pins;
}
#endif

static int32_t place(uint8_t i) {
    int32_t found;
#if SERVOS
    if (i >= DCS)
        return lroundf(motors[i].wish);
#endif
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) found = places[i];
    return found;
}

/* Power of a bridge from -255 to 255; none is a brake: the motor's coil is shorted. */
static void drive(uint8_t i, int16_t power) {
    const Bridge *bridge = &bridges[i];
    motors[i].power = power;
    if (power == 0) {
        *bridge->control &= ~(1 << bridge->bit); /* PWM would leave a needle of one part in 256 */
        return;
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        if (power > 0)
            *bridge->port |= 1 << bridge->direction;
        else
            *bridge->port &= ~(1 << bridge->direction);
    }
    *bridge->duty = abs(power);
    *bridge->control |= 1 << bridge->bit;
}

/* Let all stand where they are. */
static void stand(void) {
    for (uint8_t i = 0; i < COUNT; i++) {
        Motor *motor = &motors[i];
        motor->aim = motor->wish = place(i);
        motor->pace = motor->gain = motor->sum = 0;
        motor->before = motor->wish;
        motor->hot = motor->stuck = 0;
        motor->pace_seen = 0;
    }
    alone = 0;
}

static void fault(enum State why, uint8_t motor) {
    state = why;
    culprit = motor;
    stand();
}

/* A tick along the way: as fast as the goal can still be stopped at. */
static void move_on(uint8_t i) {
    Motor *motor = &motors[i];
    float rise = limits[i].rise / ((float)RATE * RATE), left = motor->aim - motor->wish;
    if (fabsf(left) <= rise && fabsf(motor->pace) <= 2 * rise) {
        motor->wish = motor->aim;
        motor->pace = motor->gain = 0;
        return;
    }
    float most = fminf(motor->most, sqrtf(rise * rise / 4 + 2 * rise * fabsf(left)) - rise / 2);
    float change = copysignf(most, left) - motor->pace;
    motor->gain = fmaxf(-rise, fminf(rise, change));
    motor->pace += motor->gain;
    motor->wish += motor->pace;
}

static void follow(uint8_t i) {
    Motor *motor = &motors[i];
    int32_t now = place(i);
    float error = motor->wish - now, speed = now - motor->before;
    motor->before = now;
    motor->pace_seen = fmaxf(-127, fminf(127, speed));
    motor->sum = fmaxf(-GAIN_BOUND, fminf(GAIN_BOUND, motor->sum + GAIN_I * error));
    float needed = motor->pace + motor->gain * SPIN_UP_MS * RATE / 1000;
    float power = GAIN_P * error + motor->sum + GAIN_D * (motor->pace - speed) + 255.0f * RATE / FREE_SPEED * needed;
    int16_t whole = lroundf(fmaxf(-255, fminf(255, power)));
    drive(i, abs(whole) < 4 ? 0 : whole);
    motor->hot = motor->milliamps > motor->bound ? motor->hot + 1 : 0;
    /* An encoder with one wire trembles by a count, one with swapped wires runs away: neither is motion. */
    uint8_t moves = (whole > 0 ? speed : -speed) * 10 * RATE >= FREE_SPEED;
    motor->stuck = abs(whole) > 200 && !moves ? motor->stuck + 1 : 0;
    if (motor->hot >= RATE / 20)
        fault(CURRENT, i);
    else if (motor->stuck >= RATE / 10)
        fault(STALL, i);
    else if (now < limits[i].low - BEYOND_BY || now > limits[i].high + BEYOND_BY)
        fault(BEYOND, i);
}

/* One current a tick and motor: the converter has had a whole tick for it. */
static void measure(void) {
    static uint8_t turn;
    if (!DCS)
        return;
    Motor *motor = &motors[turn];
    motor->milliamps = (uint32_t)ADC * 5000 / 1024 * 10 / SENSE; /* volts of the driver to milliamperes */
    /* Which way: that of the volts across its coil, power less what its turning induces. A motor that brakes a cable
       on the way out still pulls at it. */
    motor->pays = motor->power * (FREE_SPEED / 255.0f) < (float)RATE * motor->pace_seen;
    turn = turn + 1 < DCS ? turn + 1 : 0;
    ADMUX = 1 << REFS0 | (FIRST_CURRENT + turn);
    ADCSRA |= 1 << ADSC;
}

/* So many whole numbers, and nothing after them; 0 where they are not there. */
static uint8_t numbers(char *text, int32_t *found, uint8_t wanted) {
    for (uint8_t i = 0; i < wanted; i++) {
        char *end;
        found[i] = strtol(text, &end, 10);
        if (end == text || (*end && *end != ' '))
            return 0;
        text = end;
    }
    return *text == 0;
}

#include "moves.h"

static void tick(void) {
    measure();
    if (silence < 255)
        silence++;
    if (state == ARMED && !alone && silence >= (uint16_t)DEADLINE_MS * RATE / 1000)
        fault(SILENT, 0);
    if (lost) {
        if (state != OFF)
            fault(ENCODER, lost - 1);
        lost = zeroed = 0;
    }
    play_alone();
    for (uint8_t i = 0; i < COUNT; i++) {
        if (state == ARMED)
            move_on(i);
        if (i >= DCS)
            continue;
        if (state == ARMED || state == SILENT)
            follow(i); /* silent motors hold what they carry */
        else
            drive(i, 0);
    }
}

ISR(TIMER2_COMPA_vect) { ticks = 1; }

/* Each servo has a slot of 2.5 ms: its pulse, then rest. */
#if SERVOS
static volatile uint16_t pulses[SERVOS];
ISR(SERVO_TIMER) {
    static uint8_t turn, high;
    const ServoPin *pin = &servo_pins[turn];
    uint16_t width = pulses[turn] * 2;
    if (!high) {
        if (width)
            *pin->port |= 1 << pin->pin;
        else
            width = 1000;
        SERVO_AT += width;
    } else {
        *pin->port &= ~(1 << pin->pin);
        SERVO_AT += 5000 - (width ? width : 1000);
        turn = turn + 1 < SERVOS ? turn + 1 : 0;
    }
    high = !high;
}
#endif

/* ---- lines ---- */

static uint8_t heard, started; /* number of the last good line, and whether there was one */

static void answer(uint8_t number, const char *text) {
    char digits[4];
    say(utoa(number, digits, 10));
    put(' ');
    say(text);
}

static void refuse(const char *why) {
    say("? no ");
    say(why);
    end_line();
}

static void no(uint8_t number, const char *why) {
    answer(number, "no ");
    say(why);
    end_line();
}

static void go(uint8_t number, char *text) {
    int32_t told[2 * COUNT];
    if (state != ARMED)
        return no(number, words[state]);
    if (alone)
        return no(number, "alone");
    if (!numbers(text, told, 2 * COUNT))
        return no(number, "goals");
    for (uint8_t i = 0; i < COUNT; i++)
        if (told[2 * i] < limits[i].low || told[2 * i] > limits[i].high)
            return no(number, "limit");
    for (uint8_t i = 0; i < COUNT; i++) {
        motors[i].aim = told[2 * i];
        motors[i].most = fminf(fabsf(told[2 * i + 1]), limits[i].speed) / RATE;
    }
    answer(number, "ok");
    end_line();
}

static void arm(uint8_t number, char *text) {
    int32_t told[COUNT];
    if (!numbers(text, told, COUNT))
        return no(number, "currents");
    for (uint8_t i = 0; i < COUNT; i++)
        if (told[i] <= 0 || told[i] > limits[i].current)
            return no(number, "current");
    for (uint8_t i = 0; i < COUNT; i++)
        motors[i].bound = told[i];
    stand();
    state = ARMED;
    answer(number, "ok");
    end_line();
}

static void tell(uint8_t number) {
    answer(number, "ok ");
    say(words[state]);
    say_number(state >= CURRENT ? culprit + 1 : 0);
    for (uint8_t i = 0; i < COUNT; i++) {
        say_number(place(i));
        say_number(motors[i].pays ? -(int32_t)motors[i].milliamps : motors[i].milliamps);
    }
    end_line();
}

static void identify(uint8_t number) {
    answer(number, "ok hydrostat 1 " BOARD " " ROBOT);
    say_number(COUNT);
    say_number(DEADLINE_MS);
    say(cause & 1 << WDRF ? " watchdog" : " started");
    say(marked ? " marked" : " new");
    end_line();
}

static void obey(char *line) {
    char *text, *star = strrchr(line, '*');
    uint16_t check = 0xFFFF;
    if (!star || strlen(star) != 5)
        return refuse("checksum");
    for (text = line; text < star; text++)
        check = _crc16_update(check, *text);
    if ((uint16_t)strtoul(star + 1, &text, 16) != check || *text)
        return refuse("checksum");
    *star = 0;
    uint8_t number = strtoul(line, &text, 10);
    if (text == line || text[0] != ' ' || !text[1])
        return refuse("number");
    char word = text[1];
    uint8_t ahead = number - heard;
    if (started && word != 'I' && (ahead == 0 || ahead > 127)) {
        if (word == 'S')
            stand(); /* an old stop still stops */
        return no(number, "old");
    }
    heard = number;
    started = 1;
    silence = 0;
    text += 2;
    switch (word) {
    case 'I': return identify(number);
    case 'R': return tell(number);
    case 'G': return go(number, text);
    case 'A': return arm(number, text);
    case 'S': stand(); break;
    case 'O': stand(); state = OFF; break;
    case 'M':
        if (!keep_zeros(text))
            return no(number, "zeros");
        marked = 1;
        break;
    default: return no(number, "word");
    }
    answer(number, "ok");
    end_line();
}

static void listen(uint8_t ticked) {
    static char line[LONGEST];
    static uint8_t length, waited;
    if (length && ticked && ++waited > HALF) {
        length = 0;
        refuse("half");
    }
    while (in_tail != in_head) {
        char byte = in[in_tail];
        in_tail = (in_tail + 1) & 127;
        waited = 0;
        if (byte == '\n') {
            line[length] = 0;
            if (length)
                obey(line);
            length = 0;
        } else if (length < LONGEST - 1)
            line[length++] = byte;
        else {
            length = 0;
            refuse("long");
        }
    }
}

int main(void) {
    start_board();
    start_button();
    UBRR0 = F_CPU / 16 / BAUD_RATE - 1;
    UCSR0B = 1 << RXEN0 | 1 << TXEN0 | 1 << RXCIE0;
    ADCSRA = 1 << ADEN | 7;
    TCCR2A = 1 << WGM21; /* a tick */
    TCCR2B = 1 << CS22 | 1 << CS21 | 1 << CS20;
    OCR2A = F_CPU / 1024 / RATE - 1;
    TIMSK2 = 1 << OCIE2A;
    sum = 0xFFFF;
    old_first = FIRST_PINS;
    old_second = SECOND_PINS;
#if SERVOS
    for (uint8_t i = DCS; i < COUNT; i++) {
        motors[i].wish = limits[i].low;
        *(servo_pins[i - DCS].port - 1) |= 1 << servo_pins[i - DCS].pin; /* the register before a port is its direction */
    }
#endif
    stand();
    wdt_enable(WDTO_120MS);
    sei();
    for (;;) {
        uint8_t ticked = ticks;
        if (ticked) {
            ticks = 0;
            wdt_reset();
            tick();
#if SERVOS
            for (uint8_t i = 0; i < SERVOS; i++)
                ATOMIC_BLOCK(ATOMIC_RESTORESTATE) pulses[i] = state == OFF ? 0 : place(DCS + i);
#endif
        }
        listen(ticked);
    }
}
