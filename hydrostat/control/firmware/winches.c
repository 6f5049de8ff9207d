/* Winches of a soft robot on a board: Arduino Uno, Mega or ESP32-S3. How it talks: docs/decisions/0037-firmware.md.

   This file knows no pin and no register: avr.h and esp32s3.h do. It is C, and C++ for Arduino sketches. Motors are
   those of geared.h, DC motors with encoders, or of feetech.h, servos on one line.

   Time is counted in ticks of 4 ms, places in counts of an encoder, steps of a servo on the line, or in microseconds of
   a hobby servo's pulse.
   Five things stop a motor here: silence for DEADLINE_MS, too much current, no motion under full power, a supply below
   MIN_SUPPLY, and the hardware watchdog, which resets the processor 120 ms after the control loop ran last: pins are
   inputs then, and pull-down resistors switch the bridges off; servos are switched off as the program starts. */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifndef ROBOT /* other settings may come by -include */
#include "settings.h"
#endif

#ifndef FEETECH
static void count_step(uint8_t motor, uint8_t was, uint8_t now);
#endif
#ifdef __AVR__
#include "avr.h"
#else
#include "esp32s3.h"
#endif

#define COUNT (DCS + SERVOS)
#define LONGEST 240 /* bytes of a line */
#define HALF 12     /* ticks after which a line that came to a halt is thrown away */

#ifndef MIN_SUPPLY
#define MIN_SUPPLY 0 /* of the supply [mV]: below it for half a second, motors stop; 0 without a divider */
#endif

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

#ifndef FEETECH
enum State { OFF, ARMED, SILENT, SAGGED, CURRENT, STALL, ENCODER, BEYOND };
static const char *const words[] = {"off", "armed", "silent", "supply", "current", "stall", "encoder", "beyond"};
#else
enum State { OFF, ARMED, SILENT, SAGGED, CURRENT, STALL, ENCODER, BEYOND, HEAT, UNHEARD, RESTARTED };
static const char *const words[] = {"off",     "armed",  "silent", "supply",  "current",  "stall",
                                    "encoder", "beyond", "heat",   "unheard", "restarted"};
#endif

static const Limits limits[COUNT] = MOTORS;
static Motor motors[COUNT];
static volatile uint8_t lost; /* an encoder made a step that it cannot make */
static enum State state = OFF;
static uint8_t culprit;
static uint8_t silence; /* ticks since a good line */
static uint8_t marked; /* zeros were found since the power came on: 0 after each start */
static uint8_t zeroed; /* whether the board itself knows them, and no encoder was lost since */
#if defined(MOVE_ROWS) || defined(FEETECH)
static int32_t zeros[COUNT]; /* of the motors, if zeroed */
#endif
static uint8_t alone;  /* whether moves play without a computer, see moves.h */
static uint16_t supply; /* [mV] */
static uint8_t drained; /* stopped by it: an empty battery recovers when nothing pulls; cleared by a reset alone */

/* ---- serial line ---- */

static uint16_t sum = 0xFFFF;

static void put(char c) {
    put_byte(c);
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

static void fault(enum State why, uint8_t motor);

static uint8_t is_supply_low(void) { return MIN_SUPPLY && supply + 1UL <= MIN_SUPPLY; }

#ifdef FEETECH
#include "feetech.h"
#else
#include "geared.h"
#endif

/* Let all stand where they are. */
static void stand(void) {
    for (uint8_t i = 0; i < COUNT; i++) {
        Motor *motor = &motors[i];
        motor->aim = motor->wish = find_stop(i);
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
        if (told[2 * i] < low_of(i) || told[2 * i] > high_of(i))
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
    const char *obstacle = find_obstacle();
    if (obstacle)
        return no(number, obstacle);
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
    if (TELLS_SUPPLY)
        say_number(supply);
    end_line();
}

static void identify(uint8_t number) {
    answer(number, "ok hydrostat 1 " BOARD " " ROBOT);
    say_number(COUNT);
    say_number(DEADLINE_MS);
    say(was_hung() ? " watchdog" : " started");
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
    for (int byte; (byte = hear_byte()) >= 0;) {
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

void setup(void) {
    start_board();
#if SERVOS
    for (uint8_t i = DCS; i < COUNT; i++)
        motors[i].wish = low_of(i);
#endif
#ifdef ZEROS
    static const int32_t known[COUNT] = ZEROS;
    memcpy(zeros, known, sizeof zeros);
    zeroed = marked = 1;
#endif
    stand();
}

void loop(void) {
    uint8_t ticked = pass_tick();
    if (ticked) {
        tick();
#if SERVOS
        for (uint8_t i = DCS; i < COUNT; i++)
            set_pulse(i - DCS, state == OFF ? 0 : place(i));
#endif
    }
    listen(ticked);
}

#ifdef __AVR__
int main(void) {
    setup();
    for (;;) {
        loop();
        rest();
    }
}
#endif
