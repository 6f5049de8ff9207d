/* Hardware layer of an ESP32-S3 with Espressif's Arduino package 3: pins, and the functions that winches.cpp calls.

   Its pins withstand 3.3 V. The RTC watchdog resets the chip without the panic handler, which would print while bridges
   stay on. */
#pragma once
#include <Arduino.h>
#include <hal/wdt_hal.h>
#include <soc/rtc.h>

#define BOARD "esp32s3"
#define RATE 250      /* ticks a second, by their name */
#define TICK_US 3968UL /* as on AVR, so that moves last as long */
#define BAUD_RATE 250000UL
#define WATCHDOG_MS 120

#ifdef FEETECH
#define LINE_RATE 1000000UL
#define LINE_OUT 17 /* to TX of Waveshare's bus adapter, RX of Seeed's; each makes one line of two */
#define LINE_IN 18  /* to the other of the two */
#else
#define BRIDGES 4

typedef struct {
    uint8_t duty, direction, a, b, current;
} Bridge;

static const Bridge bridges[BRIDGES] = {
    {15, 16, 39, 40, 1}, /* PWM, direction, encoder A and B, current */
    {17, 18, 41, 42, 2},
    {11, 12, 9, 10, 4},
    {13, 14, 21, 47, 5},
};
#define SUPPLY 6 /* pin of the divider */
#if DCS > BRIDGES
#error "this board has fewer H-bridges than the robot has DC motors"
#endif
#endif
#define BUTTON 0 /* between pin 0 and GND: the button BOOT of the board */
#define LIGHT 7  /* an LED with 330 Ohm to GND */

#if SERVOS
#error "hobby servos are for Uno and Mega"
#endif

static uint16_t _crc16_update(uint16_t sum, uint8_t byte) {
    sum ^= byte;
    for (uint8_t bit_of = 0; bit_of < 8; bit_of++)
        sum = sum >> 1 ^ (sum & 1 ? 0xA001 : 0);
    return sum;
}

static uint8_t was_hung(void) {
    esp_reset_reason_t why = esp_reset_reason();
    return why == ESP_RST_WDT || why == ESP_RST_TASK_WDT || why == ESP_RST_INT_WDT || why == ESP_RST_PANIC;
}

/* The next byte that came, -1 for none. */
static int hear_byte(void) { return Serial.read(); }

static void put_byte(char c) { Serial.write((uint8_t)c); }

#ifdef FEETECH
static void write_line(const uint8_t *bytes, uint8_t count) { Serial1.write(bytes, count); }

/* The next byte that came from the servos, -1 for none. */
static int hear_line(void) { return Serial1.read(); }
#else
static volatile uint8_t channels[BRIDGES]; /* of encoders: bit 0 is A */

static void IRAM_ATTR see_step(void *which) {
    uint8_t motor = (uint8_t)(uintptr_t)which;
    uint8_t now = digitalRead(bridges[motor].a) | digitalRead(bridges[motor].b) << 1;
    count_step(motor, channels[motor], now);
    channels[motor] = now;
}

static int32_t read_count(volatile const int32_t *place) { return *place; }

/* Power of a bridge from -255 to 255; none is a brake: the motor's coil is shorted. */
static void drive_bridge(uint8_t i, int16_t power) {
    if (power)
        digitalWrite(bridges[i].direction, power > 0);
    ledcWrite(bridges[i].duty, abs(power));
}

static uint16_t measure_pin(uint8_t turn, uint8_t next) {
    (void)next;
    return analogReadMilliVolts(turn < DCS ? bridges[turn].current : SUPPLY);
}

#endif

static wdt_hal_context_t watchdog;

/* 1 once in each tick; a program that does not ask for WATCHDOG_MS is reset. */
static uint8_t pass_tick(void) {
    static uint32_t last;
    uint32_t passed = micros() - last;
    if (passed < TICK_US)
        return 0;
    last += passed < 2 * TICK_US ? TICK_US : passed;
    wdt_hal_write_protect_disable(&watchdog);
    wdt_hal_feed(&watchdog);
    wdt_hal_write_protect_enable(&watchdog);
    return 1;
}

#ifdef MOVE_ROWS
static uint8_t is_button_down(void) { return !digitalRead(BUTTON); }

static void set_light(uint8_t on) { digitalWrite(LIGHT, on); }
#endif

static void start_board(void) {
    Serial.begin(BAUD_RATE);
#ifdef FEETECH
    Serial1.begin(LINE_RATE, SERIAL_8N1, LINE_IN, LINE_OUT);
#else
    for (uint8_t i = 0; i < DCS; i++) {
        const Bridge *bridge = &bridges[i];
        pinMode(bridge->direction, OUTPUT);
        ledcAttach(bridge->duty, 62500, 8);
        ledcWrite(bridge->duty, 0);
        pinMode(bridge->a, INPUT_PULLUP);
        pinMode(bridge->b, INPUT_PULLUP);
        channels[i] = digitalRead(bridge->a) | digitalRead(bridge->b) << 1;
        attachInterruptArg(bridge->a, see_step, (void *)(uintptr_t)i, CHANGE);
        attachInterruptArg(bridge->b, see_step, (void *)(uintptr_t)i, CHANGE);
    }
#endif
#ifdef MOVE_ROWS
    pinMode(BUTTON, INPUT_PULLUP);
    pinMode(LIGHT, OUTPUT);
#endif
    wdt_hal_init(&watchdog, WDT_RWDT, 0, false);
    wdt_hal_write_protect_disable(&watchdog);
    wdt_hal_config_stage(
        &watchdog, WDT_STAGE0, (uint32_t)((uint64_t)WATCHDOG_MS * rtc_clk_slow_freq_get_hz() / 1000),
        WDT_STAGE_ACTION_RESET_SYSTEM
    );
    wdt_hal_enable(&watchdog);
    wdt_hal_write_protect_enable(&watchdog);
}
