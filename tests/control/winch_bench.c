/* The firmware in simavr, in closed loop with DC motors, gears, encoders, spools and cables; driven from Python by ctypes.
   Oracle: `winch_plant.h`, integrated at 20 kHz; it knows nothing of the firmware but its pins. */
#include "winch_plant.h"
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>
#include <string.h>

#define STEP 800 /* cycles */
static avr_t *avr;
static Plant plants[2];
static char got[1 << 16];
static int got_bytes;
static unsigned char queue[4096];
static int queued, sent;
static avr_irq_t *uart_in;
static avr_cycle_count_t byte_at, turned;

static void heard(struct avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq, (void)param;
    if (got_bytes < (int)sizeof got - 1)
        got[got_bytes++] = value;
}

static avr_int_vector_t changed; /* simavr's Mega knows no change of pins of port K */
static uint8_t pins_k;
static double rose, pulse; /* of the first servo [s] */
static double supply;      /* of the motors [V] */
static int supply_pin;

static void servo(struct avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq, (void)param;
    if (value)
        rose = avr->cycle / 16e6;
    else
        pulse = avr->cycle / 16e6 - rose;
}

static avr_ioport_external_t outside[26]; /* what drives the pins of each port, stronger than pull-ups */

static void pin(char port, int number, int value) {
    if (port == 'K' && (pins_k >> number & 1) != value) {
        pins_k ^= 1 << number;
        if (avr->data[0x6D] >> number & 1)
            avr_raise_interrupt(avr, &changed);
    }
    avr_ioport_external_t *known = &outside[port - 'A'];
    if (!(known->mask >> number & 1) || (known->value >> number & 1) != value) {
        known->name = port;
        known->mask |= 1 << number;
        known->value = (known->value & ~(1 << number)) | value << number;
        avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), known);
    }
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), number), value);
}

static void encode(Plant *plant) {
    if (plant->cut == 1)
        return;
    int phase = phase_of(plant);
    pin(plant->encoder, plant->channel, phase & 1);
    if (plant->cut != 2)
        pin(plant->encoder, plant->channel + 1, phase >> 1);
}

static avr_cycle_count_t turn(avr_t *unused, avr_cycle_count_t when, void *param) {
    (void)unused, (void)param;
    turned = when;
    for (int i = 0; i < 2; i++) {
        Plant *plant = &plants[i];
        uint8_t *data = avr->data;
        int driven = data[plant->control] >> plant->bit & 1;
        double volts = driven ? 12 * (data[plant->duty] + 1) / 256.0 : 0;
        if (!(data[plant->port] >> plant->direction & 1))
            volts = -volts;
        turn_plant(plant, volts, STEP / 16e6);
        encode(plant);
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, plant->adc), (int)(1100 * fabs(plant->current)));
    }
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, supply_pin), (int)(1000 * supply / 5.7));
    if (sent < queued && when >= byte_at) { /* a byte lasts 40 microseconds at 250,000 baud */
        avr_raise_irq(uart_in, queue[sent++]);
        byte_at = when + 640;
    }
    return when + STEP;
}

/* Skip the time of a sleeping processor; simavr's own function waits as long. */
static void pass_sleep(avr_t *unused, avr_cycle_count_t cycles) { (void)unused, (void)cycles; }

int bench_start(const char *path, const char *chip, int full) {
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(path, &firmware))
        return 1;
    avr = avr_make_mcu_by_name(chip);
    if (!avr || avr_init(avr))
        return 2;
    avr->log = LOG_NONE;
    avr->sleep = pass_sleep;
    firmware.frequency = 16000000;
    avr_load_firmware(avr, &firmware);
    avr->frequency = 16000000;
    avr->avcc = avr->aref = avr->vcc = 5000;
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    uart_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), heard, 0);
    memset(plants, 0, sizeof plants);
    got_bytes = queued = sent = 0;
    byte_at = turned = 0;
    static const Plant uno[2] = {{.duty = 0x47, .control = 0x44, .bit = 7, .port = 0x2B, .direction = 4, .adc = 4, .encoder = 'C'},
                                 {.duty = 0x48, .control = 0x44, .bit = 5, .port = 0x2B, .direction = 7, .adc = 5, .encoder = 'B'}};
    static const Plant mega[2] = {{.duty = 0x98, .control = 0x90, .bit = 7, .port = 0x22, .direction = 0, .adc = 0, .encoder = 'B'},
                                  {.duty = 0x9A, .control = 0x90, .bit = 5, .port = 0x22, .direction = 1, .adc = 1, .encoder = 'B', .channel = 2}};
    pins_k = 0;
    memset(outside, 0, sizeof outside);
    pulse = 0;
    supply = 12;
    supply_pin = strcmp(chip, "atmega328p") ? 7 : 3;
    memset(&changed, 0, sizeof changed);
    if (full) {
        changed.vector = 11;
        changed.enable = (avr_regbit_t)AVR_IO_REGBIT(0x68, 2);
        changed.raised = (avr_regbit_t)AVR_IO_REGBIT(0x3B, 2);
        avr_register_vector(avr, &changed);
        avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('C'), 0), servo, 0);
    }
    static const Plant third = {.duty = 0x9C, .control = 0x90, .bit = 3, .port = 0x22, .direction = 2, .adc = 2, .encoder = 'K'};
    for (int i = 0; i < 2; i++) {
        plants[i] = full && i ? third : strcmp(chip, "atmega328p") ? mega[i] : uno[i];
        plants[i].angle = 0.5;
        plants[i].slack = 1e9;
        encode(&plants[i]);
    }
    avr_cycle_timer_register(avr, STEP, turn, 0);
    return 0;
}

void bench_send(const unsigned char *bytes, int count) {
    if (sent == queued)
        sent = queued = 0;
    for (int i = 0; i < count && queued < (int)sizeof queue; i++)
        queue[queued++] = bytes[i];
}

/* Run so many microseconds; 1 where the processor crashed. */
int bench_run(int microseconds) {
    avr_cycle_count_t until = avr->cycle + 16ull * microseconds;
    while (avr->cycle < until) {
        int state = avr_run(avr);
        if (avr->cycle > turned + 3 * STEP) /* a reset forgets timers */
            turned = avr->cycle, avr_cycle_timer_register(avr, STEP, turn, 0);
        if (state == cpu_Done || state == cpu_Crashed)
            return 1;
    }
    return 0;
}

/* Run on with interrupts of the tick switched off: a program that hangs. */
void bench_hang(void) { avr->data[0x70] = 0; }
int bench_heard(char *into, int most) {
    int bytes = got_bytes < most ? got_bytes : most;
    memcpy(into, got, bytes);
    got_bytes = 0;
    return bytes;
}
/* Hold the button of a port and pin, or let it go. */
void bench_press(char port, int number, int down) {
    pin(port, number, !down);
}
int bench_light(void) { return avr->data[0x25] >> (avr->data[0x24] & 0x20 ? 5 : 7) & 1; } /* port B */
Plant *bench_plant(int i) { return &plants[i]; }
double bench_pulse(void) { return pulse; }
void bench_supply(double volts) { supply = volts; }
double bench_seconds(void) { return avr->cycle / 16e6; }
