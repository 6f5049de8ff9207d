/* Moves that play without a computer, in settings with MOVE_ROWS: a button starts them, and stops them.

   They begin only after word M told the zeros, and not after a fault of an encoder, of a limit or of the supply. The
   light on the board is on while a press would begin them, and blinks after the supply was too low. Everything that
   stops a motor stays; of the computer only its silence is not missed. At the end, or after a press, motors hold for
   HOLD_TICKS, then let go. */
#pragma once

#if defined(MOVE_ROWS) || defined(FEETECH)
/* Zeros of the motors, as word M tells them; without them nothing plays. */
static uint8_t keep_zeros(char *text) {
    zeroed = numbers(text, zeros, COUNT);
    return zeroed || !*text;
}
#else
static uint8_t keep_zeros(char *text) { return (void)text, 1; }
#endif

#ifdef MOVE_ROWS
#define HOLD_TICKS (2 * RATE)
#define AIM_TICKS 5 /* from one goal to the next, as from a computer: goals in each tick make the current tremble */
#define BOUNCE 5 /* ticks in which a button is steady */

enum Phase { BY_COMPUTER, ARRIVE, PLAY, HOLD };

static const int16_t moves[MOVE_ROWS][COUNT] PROGMEM = MOVES; /* from the zeros, in steps of MOVE_STEP */
static const int16_t move_ends[COUNT][2] = MOVE_ENDS;         /* least and greatest of them */
static uint16_t row, passed; /* of the table, and ticks since */

/* 1 once in each press, after 20 ms. A button that was down from the start has to be let go first. */
static uint8_t is_pressed(void) {
    static uint8_t down = 1, steady;
    uint8_t now = is_button_down();
    steady = now == down ? 0 : steady + 1;
    if (steady < BOUNCE)
        return 0;
    down = now;
    steady = 0;
    return down;
}

static uint8_t can_play(void) {
    if (!zeroed || find_obstacle() || state == ENCODER || state == BEYOND || (state == ARMED && !alone))
        return 0;
    for (uint8_t i = 0; i < COUNT; i++)
        if (zeros[i] + (int32_t)MOVE_STEP * move_ends[i][0] < low_of(i) ||
            zeros[i] + (int32_t)MOVE_STEP * move_ends[i][1] > high_of(i))
            return 0;
    return 1;
}

/* Aim at the moves at this tick; 1 where all motors are told to be there already. */
static uint8_t aim_at_moves(void) {
    uint8_t there = 1;
    for (uint8_t i = 0; i < COUNT; i++) {
        Motor *motor = &motors[i];
        float from = (int16_t)pgm_read_word(&moves[row][i]), to = from;
        if (row < MOVE_ROWS - 1)
            to = (int16_t)pgm_read_word(&moves[row + 1][i]);
        motor->aim = zeros[i] + lroundf(MOVE_STEP * (from + (to - from) * passed / MOVE_TICKS));
        motor->most = limits[i].speed / (alone == ARRIVE ? 2 * RATE : RATE);
        there &= motor->wish == motor->aim;
    }
    return there;
}

static void play_alone(void) {
    uint8_t pressed = is_pressed();
    if (pressed && (alone == ARRIVE || alone == PLAY)) {
        stand();
        alone = HOLD;
        passed = 0;
    } else if (pressed && can_play()) {
        for (uint8_t i = 0; i < COUNT; i++)
            motors[i].bound = limits[i].current;
        stand();
        state = ARMED;
        alone = ARRIVE;
        row = passed = 0;
    }
    set_light(state == SAGGED ? passed++ >> 6 & 1 : can_play());
    if (alone == HOLD && ++passed >= HOLD_TICKS) {
        stand();
        state = OFF;
    } else if (alone == ARRIVE && aim_at_moves())
        alone = PLAY;
    else if (alone == PLAY) {
        if (++passed >= MOVE_TICKS) {
            passed = 0;
            row++;
        }
        if (passed % AIM_TICKS == 0)
            aim_at_moves();
        if (row >= MOVE_ROWS - 1)
            alone = HOLD;
    }
}
#else
static void play_alone(void) {}
#endif
