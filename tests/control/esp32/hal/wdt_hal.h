/* Stand-in for the RTC watchdog of Espressif's IDF 5. */
#pragma once
#include <cstdint>

typedef struct {
    int instance;
} wdt_hal_context_t;
typedef enum { WDT_MWDT0, WDT_MWDT1, WDT_RWDT } wdt_inst_t;
typedef enum { WDT_STAGE0 } wdt_stage_t;
typedef enum { WDT_STAGE_ACTION_OFF, WDT_STAGE_ACTION_INT, WDT_STAGE_ACTION_RESET_CPU, WDT_STAGE_ACTION_RESET_SYSTEM } wdt_stage_action_t;

extern "C" {
void wdt_hal_init(wdt_hal_context_t *hal, wdt_inst_t instance, uint32_t prescaler, bool enable_intr);
void wdt_hal_write_protect_disable(wdt_hal_context_t *hal);
void wdt_hal_write_protect_enable(wdt_hal_context_t *hal);
void wdt_hal_config_stage(wdt_hal_context_t *hal, wdt_stage_t stage, uint32_t ticks, wdt_stage_action_t action);
void wdt_hal_enable(wdt_hal_context_t *hal);
void wdt_hal_feed(wdt_hal_context_t *hal);
}
