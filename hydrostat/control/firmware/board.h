/* Which pin does what, on the two boards. */
#pragma once
#include <avr/io.h>

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
    {&OCR0B, &TCCR0A, COM0B1, &PORTD, 7, 2}, /* PWM 5, direction 7, encoder A2 A3, current A5 */
};
#define FIRST_CURRENT 4
#define FIRST_BRIDGES 2 /* on the first port of encoders */
#define FIRST_PINS PINC
#define SECOND_PINS PINC
#define FIRST_vect PCINT1_vect
#define LINE_IN USART_RX_vect
#define LINE_OUT USART_UDRE_vect
static const ServoPin servo_pins[] = {{&PORTB, 0}, {&PORTB, 1}, {&PORTB, 2}, {&PORTB, 3}, {&PORTB, 4}, {&PORTD, 3}};
#define SERVO_TIMER TIMER1_COMPA_vect
#define SERVO_AT OCR1A
#define SERVO_NOW TCNT1
#define BUTTON 2 /* between pin 2 and GND */
#define BUTTON_PORT PORTD
#define BUTTON_PINS PIND
#define LIGHT 5 /* pin 13 */
static void start_board(void) {
    DDRD |= 1 << 6 | 1 << 5 | 1 << 4 | 1 << 7;
    PORTC |= 0x0F;                     /* pull-ups of encoders */
    TCCR0A = 1 << WGM01 | 1 << WGM00;  /* 62.5 kHz */
    TCCR0B = 1 << CS00;
    PCICR = 1 << PCIE1;
    PCMSK1 = 0x0F;
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
static void start_board(void) {
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
