/* Hardware layer of Uno and Mega: which pin does what, and what winches.c asks of a board. */
#pragma once
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdlib.h>
#include <util/atomic.h>
#include <util/crc16.h>

#define RATE 250 /* ticks a second, by their name: one lasts 3.968 ms */
#define BAUD_RATE 250000UL

typedef struct {
    volatile uint8_t *duty;    /* compare register of the PWM that enables the H-bridge */
    volatile uint8_t *control; /* of its timer; `bit` joins the pin to it */
    uint8_t bit;
    volatile uint8_t *port; /* of the direction */
    uint8_t direction;
    uint8_t channel; /* of the encoder: bit of A in its port, B is one higher */
} Bridge;

typedef struct {
    volatile uint8_t *port;
    uint8_t pin;
} ServoPin;

#if defined(__AVR_ATmega328P__)
#define BOARD "uno"
#define BRIDGES 2
static const Bridge bridges[BRIDGES] = {
    {&OCR0A, &TCCR0A, COM0A1, &PORTD, 4, 0}, /* PWM 6, direction 4, encoder A0 A1, current A4 */
    {&OCR0B, &TCCR0A, COM0B1, &PORTD, 7, 0}, /* PWM 5, direction 7, encoder 8 9, current A5 */
};
#define FIRST_CURRENT 4
#define SUPPLY 3        /* pin A3 */
#define FIRST_BRIDGES 1 /* on the first port of encoders */
#define FIRST_PINS PINC
#define SECOND_PINS PINB
#define FIRST_vect PCINT1_vect
#define SECOND_vect PCINT0_vect
#define LINE_IN USART_RX_vect
#define LINE_OUT USART_UDRE_vect
static const ServoPin servo_pins[] = {{&PORTB, 2}, {&PORTB, 3}, {&PORTB, 4}, {&PORTD, 3}}; /* 10 to 12, 3 */
#define SERVO_TIMER TIMER1_COMPA_vect
#define SERVO_AT OCR1A
#define SERVO_NOW TCNT1
#define BUTTON 2 /* between pin 2 and GND */
#define BUTTON_PORT PORTD
#define BUTTON_PINS PIND
#define LIGHT 5 /* pin 13 */
static void set_pins(void) {
    DDRD |= 1 << 6 | 1 << 5 | 1 << 4 | 1 << 7;
    PORTC |= 0x03;                     /* pull-ups of encoders */
    PORTB |= 0x03;
    TCCR0A = 1 << WGM01 | 1 << WGM00;  /* 62.5 kHz */
    TCCR0B = 1 << CS00;
    PCICR = 1 << PCIE1 | (DCS > 1) << PCIE0;
    PCMSK1 = 0x03;
    PCMSK0 = 0x03;
    TCCR1B = 1 << CS11;                /* half a microsecond */
    TIMSK1 = SERVOS ? 1 << OCIE1A : 0;
}
#elif defined(__AVR_ATmega2560__)
#define BOARD "mega"
#define BRIDGES 6
#define LOW_BYTE(x) ((volatile uint8_t *)&(x))
static const Bridge bridges[BRIDGES] = {
    {LOW_BYTE(OCR3A), &TCCR3A, COM3A1, &PORTA, 0, 0}, /* PWM 5, direction 22, encoder 53 52, current A0 */
    {LOW_BYTE(OCR3B), &TCCR3A, COM3B1, &PORTA, 1, 2}, /* 2, 23, 51 50, A1 */
    {LOW_BYTE(OCR3C), &TCCR3A, COM3C1, &PORTA, 2, 0}, /* 3, 24, A8 A9, A2 */
    {LOW_BYTE(OCR4A), &TCCR4A, COM4A1, &PORTA, 3, 2}, /* 6, 25, A10 A11, A3 */
    {LOW_BYTE(OCR4B), &TCCR4A, COM4B1, &PORTA, 4, 4}, /* 7, 26, A12 A13, A4 */
    {LOW_BYTE(OCR4C), &TCCR4A, COM4C1, &PORTA, 5, 6}, /* 8, 27, A14 A15, A5 */
};
#define FIRST_CURRENT 0
#define SUPPLY 7 /* pin A7 */
#define FIRST_BRIDGES 2
#define FIRST_PINS PINB
#define SECOND_PINS PINK
#define FIRST_vect PCINT0_vect
#define SECOND_vect PCINT2_vect
#define LINE_IN USART0_RX_vect
#define LINE_OUT USART0_UDRE_vect
static const ServoPin servo_pins[] = {{&PORTC, 0}, {&PORTC, 1}, {&PORTC, 2}, {&PORTC, 3},
                                      {&PORTC, 4}, {&PORTC, 5}, {&PORTC, 6}, {&PORTC, 7}}; /* 37 down to 30 */
#define SERVO_TIMER TIMER5_COMPA_vect
#define SERVO_AT OCR5A
#define SERVO_NOW TCNT5
#define BUTTON 6 /* between pin 12 and GND */
#define BUTTON_PORT PORTB
#define BUTTON_PINS PINB
#define LIGHT 7 /* pin 13 */
static void set_pins(void) {
    DDRE |= 1 << 3 | 1 << 4 | 1 << 5;
    DDRH |= 1 << 3 | 1 << 4 | 1 << 5;
    DDRA |= 0x3F;
    PORTK = 0xFF;
    PORTB |= 0x0F;
    TCCR3A = TCCR4A = 1 << WGM30; /* fast PWM of 8 bits, 62.5 kHz */
    TCCR3B = TCCR4B = 1 << WGM32 | 1 << CS30;
    PCICR = 1 << PCIE0 | 1 << PCIE2;
    PCMSK0 = 0x0F;
    PCMSK2 = 0xFF;
    TCCR5B = 1 << CS51;
    TIMSK5 = SERVOS ? 1 << OCIE5A : 0;
}
#else
#error "the boards are Uno (ATmega328P) and Mega (ATmega2560)"
#endif

#define LIGHT_PORT PORTB
#define LIGHT_DIRECTION DDRB

#if DCS > BRIDGES
#error "this board has fewer H-bridges than the robot has DC motors"
#endif

/* The watchdog still runs after it has reset the processor: it is switched off before anything else. */
static uint8_t cause __attribute__((section(".noinit")));
void begin(void) __attribute__((naked, used, section(".init3")));
void begin(void) {
    cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
}

static uint8_t was_hung(void) { return cause & 1 << WDRF; }

/* ---- serial line ---- */

static volatile uint8_t in[128], in_head, in_tail, out_head, out_tail;
static volatile uint8_t out[256];

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

/* The next byte that came, -1 for none. */
static int hear_byte(void) {
    if (in_tail == in_head)
        return -1;
    uint8_t byte = in[in_tail];
    in_tail = (in_tail + 1) & 127;
    return byte;
}

static void put_byte(char c) {
    while ((uint8_t)(out_head + 1) == out_tail)
        ; /* the watchdog bounds this wait */
    out[out_head] = c;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        out_head++;
        UCSR0B |= 1 << UDRIE0;
    }
}

/* ---- motors ---- */

static uint8_t old_first, old_second;
#if DCS
ISR(FIRST_vect) {
    uint8_t pins = FIRST_PINS;
    for (uint8_t i = 0; i < DCS && i < FIRST_BRIDGES; i++)
        count_step(i, old_first >> bridges[i].channel & 3, pins >> bridges[i].channel & 3);
    old_first = pins;
}
#endif
#if DCS > FIRST_BRIDGES
ISR(SECOND_vect) {
    uint8_t pins = SECOND_PINS;
    for (uint8_t i = FIRST_BRIDGES; i < DCS; i++)
        count_step(i, old_second >> bridges[i].channel & 3, pins >> bridges[i].channel & 3);
    old_second = pins;
}
#endif

static int32_t read_count(volatile const int32_t *place) {
    int32_t found;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) found = *place;
    return found;
}

/* Power of a bridge from -255 to 255; none is a brake: the motor's coil is shorted. */
static void drive_bridge(uint8_t i, int16_t power) {
    const Bridge *bridge = &bridges[i];
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

/* Millivolts of a driver's current pin, or of the supply's after the last, which the converter had a whole tick for;
   then it begins with the next. */
static uint16_t measure_pin(uint8_t turn, uint8_t next) {
    (void)turn;
    uint16_t found = (uint32_t)ADC * 5000 / 1024;
    ADMUX = 1 << REFS0 | (next < DCS ? FIRST_CURRENT + next : SUPPLY);
    ADCSRA |= 1 << ADSC;
    return found;
}

static volatile uint8_t ticks;
ISR(TIMER2_COMPA_vect) { ticks = 1; }

/* 1 once in each tick; a program that does not ask for 120 ms is reset. */
static uint8_t pass_tick(void) {
    if (!ticks)
        return 0;
    ticks = 0;
    wdt_reset();
    return 1;
}

/* Sleep until an interrupt if no tick and no byte waits: timers, converter and watchdog go on. */
static void rest(void) {
    cli();
    if (!ticks && in_tail == in_head) {
        sei(); /* an interrupt comes after the next instruction at the earliest, so none is slept through */
        sleep_cpu();
    }
    sei();
}

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

static void set_pulse(uint8_t servo, uint16_t microseconds) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) pulses[servo] = microseconds;
}
#endif

/* ---- button and light ---- */

#ifdef MOVE_ROWS
static uint8_t is_button_down(void) { return !(BUTTON_PINS & 1 << BUTTON); }

static void set_light(uint8_t on) {
    if (on)
        LIGHT_PORT |= 1 << LIGHT;
    else
        LIGHT_PORT &= ~(1 << LIGHT);
}
#endif

static void start_board(void) {
    set_pins();
#ifdef MOVE_ROWS
    BUTTON_PORT |= 1 << BUTTON; /* pull-up */
    LIGHT_DIRECTION |= 1 << LIGHT;
#endif
    UBRR0 = F_CPU / 16 / BAUD_RATE - 1;
    UCSR0B = 1 << RXEN0 | 1 << TXEN0 | 1 << RXCIE0;
    ADCSRA = 1 << ADEN | 7;
    TCCR2A = 1 << WGM21; /* a tick */
    TCCR2B = 1 << CS22 | 1 << CS21 | 1 << CS20;
    OCR2A = F_CPU / 1024 / RATE - 1;
    TIMSK2 = 1 << OCIE2A;
    old_first = FIRST_PINS;
    old_second = SECOND_PINS;
#if SERVOS
    for (uint8_t i = 0; i < SERVOS; i++)
        *(servo_pins[i].port - 1) |= 1 << servo_pins[i].pin; /* the register before a port is its direction */
#endif
    SMCR = 1 << SE; /* the instruction sleep stops the processor alone */
    wdt_enable(WDTO_120MS);
    sei();
}
