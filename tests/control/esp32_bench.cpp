/* The sketch for an ESP32-S3 on this computer, in closed loop with the plants of `winch_plant.h`; by ctypes, as
   `winch_bench.c`. The sketch is a library of its own: a reset of the chip loads it anew. */
#include "winch_plant.h"
#include <Arduino.h>
#include <cstdio>
#include <dlfcn.h>
#include <hal/wdt_hal.h>
#include <soc/rtc.h>
#include <string>

static const double STEP = 50e-6; /* s */
static const int PINS = 49;

struct Pin {
    int mode, level, duty; /* duty -1: no PWM */
    void (*called)(void *);
    void *given;
};

HardwareSerial Serial, Serial1;
static Pin pins[PINS];
static int second[2]; /* pin of channel B of each plant */
static Plant plants[2];
static double supply; /* of the motors [V] */
static double now, byte_at, fed, patience; /* patience 0: no watchdog */
static bool hung, is_protected, opened;
static esp_reset_reason_t reason;
static std::string sketch, got, queue;
static std::string told, answers; /* of the line of servos */
static void *loaded;
static void (*run_loop)();

/* Levels of two pins from outside: both are there before an interrupt sees one. */
static void drive_pins(int one, int level, int other, int other_level) {
    const int both[2] = {one, other}, changed[2] = {pins[one].level != level, pins[other].level != other_level};
    pins[one].level = level, pins[other].level = other_level;
    for (int i = 0; i < 2; i++)
        if (changed[i] && pins[both[i]].called)
            pins[both[i]].called(pins[both[i]].given);
}

static void encode(int i) {
    if (plants[i].cut == 1)
        return;
    int phase = phase_of(&plants[i]), b = plants[i].cut == 2 ? pins[second[i]].level : phase >> 1;
    drive_pins(plants[i].channel, phase & 1, second[i], b);
}

static int start(esp_reset_reason_t why) {
    for (Pin &pin : pins)
        pin.mode = 0, pin.duty = -1, pin.called = nullptr;
    patience = 0, hung = opened = false, is_protected = true, reason = why;
    if (loaded)
        dlclose(loaded);
    loaded = dlopen(sketch.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!loaded)
        return fprintf(stderr, "%s\n", dlerror()), 1;
    run_loop = (void (*)())dlsym(loaded, "loop");
    ((void (*)())dlsym(loaded, "setup"))();
    return 0;
}

extern "C" {
unsigned long micros() { return (uint32_t)llround(1e6 * now); }
void pinMode(uint8_t pin, uint8_t mode) { pins[pin].mode = mode; }
void digitalWrite(uint8_t pin, uint8_t value) {
    if (pins[pin].mode == OUTPUT)
        pins[pin].level = value;
}
int digitalRead(uint8_t pin) { return pins[pin].level; }
void attachInterruptArg(uint8_t pin, void (*called)(void *), void *given, int) {
    pins[pin].called = called, pins[pin].given = given;
}
uint32_t analogReadMilliVolts(uint8_t pin) {
    for (Plant &plant : plants)
        if (plant.adc == pin)
            return fmin(3100, 1100 * fabs(plant.current)); /* the converter reads no more */
    return pin == 6 ? fmin(3100, 1000 * supply / 5.7) : 0;
}
bool ledcAttach(uint8_t pin, uint32_t, uint8_t) { return pins[pin].duty = 0, true; }
bool ledcWrite(uint8_t pin, uint32_t duty) { return pins[pin].duty < 0 ? false : (pins[pin].duty = duty, true); }
esp_reset_reason_t esp_reset_reason() { return reason; }
char *ltoa(long value, char *into, int) { return sprintf(into, "%ld", value), into; }
char *utoa(unsigned value, char *into, int) { return sprintf(into, "%u", value), into; }
uint32_t rtc_clk_slow_freq_get_hz() { return 136000; }
void wdt_hal_init(wdt_hal_context_t *hal, wdt_inst_t instance, uint32_t, bool) { hal->instance = instance; }
void wdt_hal_write_protect_disable(wdt_hal_context_t *) { is_protected = false; }
void wdt_hal_write_protect_enable(wdt_hal_context_t *) { is_protected = true; }
void wdt_hal_config_stage(wdt_hal_context_t *, wdt_stage_t, uint32_t ticks, wdt_stage_action_t action) {
    if (!is_protected && action == WDT_STAGE_ACTION_RESET_SYSTEM)
        patience = ticks / 136000.0;
}
void wdt_hal_enable(wdt_hal_context_t *) { fed = now; }
void wdt_hal_feed(wdt_hal_context_t *) {
    if (!is_protected)
        fed = now;
}

/* Pins of the motor of a plant, as a maker wires them. */
void bench_wire(int i, int pwm, int direction, int a, int b, int current) {
    plants[i] = {};
    plants[i].duty = pwm, plants[i].direction = direction, plants[i].channel = a, second[i] = b, plants[i].adc = current;
    plants[i].angle = 0.5, plants[i].slack = 1e9;
}

int bench_start(const char *path, const char *, int) {
    sketch = path, now = byte_at = 0, supply = 12;
    got.clear(), queue.clear(), told.clear(), answers.clear();
    for (Pin &pin : pins)
        pin = {0, 1, -1, nullptr, nullptr};
    for (int i = 0; i < 2; i++)
        encode(i);
    return start(ESP_RST_POWERON);
}

void bench_send(const unsigned char *bytes, int count) { queue.append((const char *)bytes, count); }

int bench_run(int microseconds) {
    for (double until = now + 1e-6 * microseconds; now < until - 1e-9; now += STEP) {
        for (int i = 0; i < 2; i++) {
            Plant *plant = &plants[i];
            int duty = pins[plant->duty].duty;
            double volts = duty <= 0 ? 0 : 12 * (duty >= 255 ? 1 : duty / 256.0);
            turn_plant(plant, pins[plant->direction].level && pins[plant->direction].mode == OUTPUT ? volts : -volts, STEP);
            encode(i);
        }
        if (patience > 0 && now > fed + patience && start(ESP_RST_WDT))
            return 1;
        if (!hung)
            run_loop();
    }
    return 0;
}

void bench_hang() { hung = true; }
int bench_heard(char *into, int most) {
    int bytes = fmin(got.size(), most);
    memcpy(into, got.data(), bytes);
    got.clear();
    return bytes;
}
/* Bytes that it sent to the servos, and theirs. */
int bench_told(char *into, int most) {
    int bytes = fmin(told.size(), most);
    memcpy(into, told.data(), bytes);
    told.clear();
    return bytes;
}
void bench_answer(const unsigned char *bytes, int count) { answers.append((const char *)bytes, count); }
void bench_press(char, int number, int down) { pins[number].level = !down; }
int bench_light() { return pins[7].mode == OUTPUT && pins[7].level; }
Plant *bench_plant(int i) { return &plants[i]; }
double bench_pulse() { return 0; }
void bench_supply(double volts) { supply = volts; }
double bench_seconds() { return now; }
}

void HardwareSerial::begin(unsigned long baud, uint32_t, int8_t rx, int8_t tx) {
    opened = this == &Serial ? baud == 250000 : opened && baud == 1000000 && rx == 18 && tx == 17;
}
int HardwareSerial::read() {
    bool is_line = this == &Serial1;
    std::string &from = is_line ? answers : queue;
    if (!opened || from.empty() || (!is_line && now < byte_at))
        return -1;
    if (!is_line)
        byte_at = now + 40e-6; /* a byte lasts so long at 250,000 baud */
    int byte = (unsigned char)from[0];
    from.erase(0, 1);
    return byte;
}
size_t HardwareSerial::write(uint8_t byte) { return opened ? got.push_back(byte), 1 : 0; }
size_t HardwareSerial::write(const uint8_t *bytes, size_t count) {
    return told.append((const char *)bytes, opened ? count : 0), count;
}
