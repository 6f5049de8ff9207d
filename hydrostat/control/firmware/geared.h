/* Geared DC motors with encoders: `winches.c` includes this file, or the backend of another kind of motor.

   A motor is driven by power; its encoder gives the position, its driver the current, a divider the supply. */
#pragma once

/* Power of 255 by counts of error, of error summed over ticks, and of error of speed a tick. */
#define GAIN_P 1.8f
#define GAIN_I 0.02f
#define GAIN_D 6.5f
#define GAIN_BOUND 120.0f
#ifndef SPIN_UP_MS
#define SPIN_UP_MS 20 /* in which a motor without load comes to two thirds of its speed */
#endif
#define BEYOND_BY 100 /* counts past a limit at which something is wrong */
#define TELLS_SUPPLY (MIN_SUPPLY > 0) /* with a divider */
#define SENSE 11      /* volts at the driver's current pin, by amperes, times ten */
#define DIVIDER 57    /* volts of the supply, by those at its pin, times ten: 47 kOhm over 10 kOhm */

static volatile int32_t places[COUNT]; /* of encoders */
static uint8_t sagging;                /* readings in a row below MIN_SUPPLY */

/* An encoder's channels went from one state to another, bit 0 is A: called by interrupts. */
static void count_step(uint8_t motor, uint8_t was, uint8_t now) {
    static const int8_t steps[16] = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};
    int8_t step = steps[was << 2 | now];
    if (step == 2)
        lost = motor + 1;
    else
        places[motor] += limits[motor].sign > 0 ? step : -step;
}

static int32_t place(uint8_t i) {
#if SERVOS
    if (i >= DCS)
        return lroundf(motors[i].wish);
#endif
    return read_count(&places[i]);
}

/* Where it stops. */
static int32_t find_stop(uint8_t i) { return place(i); }

static void drive(uint8_t i, int16_t power) {
    motors[i].power = power;
    drive_bridge(i, power);
}

/* Least and greatest place that a motor may have. */
static int32_t low_of(uint8_t i) { return limits[i].low; }
static int32_t high_of(uint8_t i) { return limits[i].high; }

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
    else if (now < low_of(i) - BEYOND_BY || now > high_of(i) + BEYOND_BY)
        fault(BEYOND, i);
}

/* Reason why no motor may be armed, 0 for none. */
static const char *find_obstacle(void) { return drained || is_supply_low() ? "supply" : 0; }

/* A moment in which motors start lets a good battery sag, too. */
static void watch_supply(uint16_t millivolts) {
    supply = (uint32_t)millivolts * DIVIDER / 10;
    sagging = is_supply_low() ? sagging + (sagging < 255) : 0;
    if (sagging * (DCS + 1) >= RATE / 2 && (state == ARMED || state == SILENT)) {
        drained = 1;
        fault(SAGGED, 0);
    }
}

/* One current a tick and motor, then the supply. */
static void measure(void) {
    static uint8_t turn;
    if (!DCS)
        return;
    uint8_t next = turn + 1 < DCS + (MIN_SUPPLY > 0) ? turn + 1 : 0;
    uint16_t millivolts = measure_pin(turn, next);
    Motor *motor = &motors[turn];
    if (turn == DCS) {
        turn = next;
        return watch_supply(millivolts);
    }
    motor->milliamps = (uint32_t)millivolts * 10 / SENSE; /* volts of the driver to milliamperes */
    /* Which way: that of the volts across its coil, power less what its turning induces. A motor that brakes a cable
       on the way out still pulls at it. */
    motor->pays = motor->power * (FREE_SPEED / 255.0f) < (float)RATE * motor->pace_seen;
    turn = next;
}
