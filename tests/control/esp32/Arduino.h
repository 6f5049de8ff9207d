/* Stand-in for Espressif's Arduino package 3, as much as the firmware uses of it; `esp32_bench.cpp` has the functions. */
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

using std::abs;

#define LOW 0x0
#define HIGH 0x1
#define INPUT 0x01
#define OUTPUT 0x03
#define INPUT_PULLUP 0x05
#define CHANGE 0x03
#define IRAM_ATTR
#define PROGMEM
#define pgm_read_word(address) (*(const uint16_t *)(address))

typedef enum { ESP_RST_UNKNOWN, ESP_RST_POWERON, ESP_RST_EXT, ESP_RST_SW, ESP_RST_PANIC, ESP_RST_INT_WDT, ESP_RST_TASK_WDT, ESP_RST_WDT } esp_reset_reason_t;

extern "C" {
void setup(void);
void loop(void);
unsigned long micros(void);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int digitalRead(uint8_t pin);
void attachInterruptArg(uint8_t pin, void (*called)(void *), void *given, int mode);
uint32_t analogReadMilliVolts(uint8_t pin);
bool ledcAttach(uint8_t pin, uint32_t frequency, uint8_t bits);
bool ledcWrite(uint8_t pin, uint32_t duty);
esp_reset_reason_t esp_reset_reason(void);
char *ltoa(long value, char *into, int base);
char *utoa(unsigned value, char *into, int base);
}

#define SERIAL_8N1 0x800001c

struct HardwareSerial {
    void begin(unsigned long baud, uint32_t config = SERIAL_8N1, int8_t rx = -1, int8_t tx = -1);
    int read();
    size_t write(uint8_t byte);
    size_t write(const uint8_t *bytes, size_t count);
};
extern HardwareSerial Serial, Serial1;
