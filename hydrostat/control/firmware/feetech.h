/* Feetech servos on one half-duplex line, in place of geared.h: the settings have their registers and rules.

   Packet: FF FF, number, length, instruction or error, parameters, complement of the sum. In each tick the answer to
   the last question is read, torque is switched if the state wants it, goals go out every GOAL_TICKS, and the next
   servo is asked. A place is a step of the servo's own count but for whole turns (`base`), so zeros are those that a
   computer on the same line finds.

   Nothing confirms a packet to all servos, thus the board repeats it: torque off every GOAL_TICKS as long as it is
   meant, lock and bounds until each servo shows them, and only then torque on.

   These servos have no watchdog. A board that falls silent leaves them at their last goal: at most GOAL_TICKS ahead of
   the planned place, and LEAD_MS of full speed ahead of the servo. As it starts again, torque goes off on the line. */
#pragma once

#define GOAL_TICKS 5   /* from one goal to the next */
#define BEYOND_BY 100  /* steps past a limit at which something is wrong */
#define TAKE_TICKS (RATE / 2) /* in which a servo has to show its lock, its bound and torque */
#define TELLS_SUPPLY 1 /* each servo measures it */
#if COUNT > 16
#error "a line has at most 16 servos: their answers would be late"
#endif
#define LATE (HEARD_MS * RATE / 1000)

typedef struct {
    int32_t place, low, high; /* step now, and steps that it may go to: none before it said who it is */
    int32_t base;             /* steps of whole turns by which it counts less than its zero does */
    float goal;               /* told last */
    const char *refused;      /* why it cannot be used */
    uint8_t least, most;      /* supply in its memory [0.1 V] */
    uint8_t volts, heat, errors;
    uint8_t sags;    /* answers in a row with an error of the supply: 2 for many */
    uint8_t age;     /* ticks since its last answer, 255 for many or none */
    uint8_t jumped;  /* the last answer was a turn off */
    uint8_t on;      /* its torque was seen on since arming */
    uint8_t taken;   /* steps of arming that its last answer shows */
    uint8_t delay;   /* ticks since it showed all of them */
} Servo;

enum Taken { NOTHING, LOCKED, BOUNDED, POWERED }; /* steps of arming */

static Servo servos[COUNT];
static const float millimeters[COUNT] = MILLIMETERS; /* of cable, in steps */
static uint8_t is_armed, is_on; /* whether torque is meant to be on, and was switched on */
static uint8_t all_taken;       /* steps of arming that all have taken */
static uint16_t sagging;        /* ticks below MIN_SUPPLY */

/* ---- packets ---- */

static uint8_t packet[16 * COUNT + 16], packed;

static void add(uint8_t byte) { packet[packed++] = byte; }

static void add_word(uint16_t word) {
    add(BIG_WORDS ? word >> 8 : word);
    add(BIG_WORDS ? word : word >> 8);
}

static void begin_packet(uint8_t number, uint8_t instruction) {
    packed = 0;
    add(0xFF);
    add(0xFF);
    add(number);
    add(0);
    add(instruction);
}

static uint8_t sum_up(const uint8_t *bytes, uint16_t count) {
    uint8_t found = 0;
    while (count--)
        found += *bytes++;
    return ~found;
}

static void send_packet(void) {
    packet[3] = packed - 3;
    add(sum_up(packet + 2, packed - 2));
    write_line(packet, packed);
}

static uint16_t word_at(const uint8_t *place) {
    return BIG_WORDS ? place[0] << 8 | place[1] : place[1] << 8 | place[0];
}

/* A number whose sign is a bit of its own. */
static int32_t signed_at(const uint8_t *place, uint8_t bit) {
    uint16_t word = word_at(place);
    return word >> bit & 1 ? -(int32_t)(word & ((1 << bit) - 1)) : word;
}

/* ---- motors ---- */

static int32_t place(uint8_t i) { return servos[i].place; }

/* Where it is now if it follows: its last answer is some ticks old. */
static int32_t find_stop(uint8_t i) {
    return servos[i].place + lroundf(motors[i].pace * fminf(servos[i].age, COUNT + 1));
}

/* Least and greatest place: those of the servo, and those of the winch once its zero is known. */
static int32_t low_of(uint8_t i) {
    int32_t low = lroundf(zeros[i] + limits[i].low - millimeters[i] * (alone ? ALONE_SPARE : GUIDED_SPARE));
    int32_t least = servos[i].low + servos[i].base;
    return !zeroed || low < least ? least : low;
}

static int32_t high_of(uint8_t i) {
    int32_t high = lroundf(zeros[i] + limits[i].high + millimeters[i] * (alone ? ALONE_SPARE : GUIDED_SPARE));
    int32_t most = servos[i].high + servos[i].base;
    return !zeroed || high > most ? most : high;
}

static void drive(uint8_t i, int16_t power) { motors[i].power = power; }

static void follow(uint8_t i) {
    Motor *motor = &motors[i];
    Servo *servo = &servos[i];
    int32_t now = servo->place;
    if (!is_on) { /* goals wait for torque */
        motor->wish = now;
        motor->pace = 0;
    }
    uint8_t follows = fabsf(motor->wish - now) < millimeters[i] * STALL_MM;
    follows |= fabsf((float)now - motor->before) > millimeters[i] / 10;
    if (follows)
        motor->before = now;
    motor->stuck = follows ? 0 : motor->stuck + 1;
    if (servo->age > LATE)
        fault(UNHEARD, i);
    else if (servo->sags > 1) {
        drained = 1;
        fault(SAGGED, i);
    } else if (servo->errors & FAULT_HEAT || servo->heat > MAX_HEAT)
        fault(HEAT, i);
    else if (servo->errors & FAULT_ENCODER)
        fault(ENCODER, i);
    else if (servo->errors & ~FAULT_SUPPLY)
        fault(CURRENT, i);
    else if (servo->delay > TAKE_TICKS && servo->taken <= all_taken)
        fault(UNHEARD, i);
    else if (now < low_of(i) - BEYOND_BY || now > high_of(i) + BEYOND_BY)
        fault(BEYOND, i);
    else if (motor->stuck >= STALL_MS * RATE / 1000)
        fault(STALL, i);
}

/* ---- what they are told ---- */

static void write_byte(uint8_t register_at, uint8_t value) {
    begin_packet(ALL_SERVOS, TO_WRITE);
    add(register_at);
    add(value);
    send_packet();
}

/* Goals of the next GOAL_TICKS, never far ahead of the servo; as fast as the goal moves, and faster if it is behind. */
static void write_goals(void) {
    begin_packet(ALL_SERVOS, TO_SYNC_WRITE);
    add(GOAL_AT);
    add(GOAL_BYTES);
    for (uint8_t i = 0; i < COUNT; i++) {
        const Motor *motor = &motors[i];
        Servo *servo = &servos[i];
        float next = motor->wish + motor->pace * GOAL_TICKS, ahead = limits[i].speed * LEAD_MS / 1000;
        next = motor->pace > 0 ? fminf(next, fmaxf(motor->aim, motor->wish))
                               : fmaxf(next, fminf(motor->aim, motor->wish));
        next = fmaxf(servo->place - ahead, fminf(servo->place + ahead, next));
        next = fmaxf(servo->low + servo->base, fminf(servo->high + servo->base, next));
        float rate = fabsf(next - servo->goal) * RATE / GOAL_TICKS + fabsf(servo->goal - servo->place) * 10;
        int32_t step = lroundf(next) - servo->base;
        servo->goal = next;
        add(i + 1);
        if (GOAL_BYTES > 6)
            add(0); /* no bound of acceleration, to stop soon */
        add_word(step < 0 ? -step | 0x8000 : step);
        add_word(0);
        add_word(lroundf(fmaxf(1 + limits[i].speed / 50, fminf(fminf(rate, limits[i].speed), MAX_RATE))));
    }
    send_packet();
}

/* Bound of torque, as a share. */
static uint16_t share_of(uint8_t i) {
    return fmaxf(1, fminf(FULL_TORQUE, lroundf((float)FULL_TORQUE * motors[i].bound / STALL_MA)));
}

static void write_bounds(void) {
    begin_packet(ALL_SERVOS, TO_SYNC_WRITE);
    add(BOUND_AT);
    add(2);
    for (uint8_t i = 0; i < COUNT; i++) {
        add(i + 1);
        add_word(share_of(i));
    }
    send_packet();
}

/* The step that a servo lacks: lock, then bounds, then goals where they stand and torque. Or torque off. */
static void write_switches(void) {
    all_taken = POWERED;
    for (uint8_t i = 0; i < COUNT; i++)
        if (servos[i].taken < all_taken)
            all_taken = servos[i].taken;
    if (!is_armed)
        return write_byte(TORQUE_AT, is_on = 0);
    if (all_taken == BOUNDED && !is_on) {
        for (uint8_t i = 0; i < COUNT; i++)
            servos[i].goal = servos[i].place;
        is_on = 1;
    }
    if (is_on)
        write_goals();
    if (LOCK_AT && all_taken == NOTHING)
        write_byte(LOCK_AT, 1); /* else the servo keeps its bound of torque for good */
    else if (all_taken < BOUNDED)
        write_bounds();
    else if (all_taken == BOUNDED)
        write_byte(TORQUE_AT, 1);
}

/* ---- what they answer ---- */

static void take_head(uint8_t i, const uint8_t *table) {
    Servo *servo = &servos[i];
    static const uint16_t models[] = MODELS;
    uint8_t known = 0;
    for (uint8_t kind = 0; kind < sizeof models / sizeof *models; kind++)
        known |= word_at(table + MODEL_AT) == models[kind];
    servo->low = signed_at(table + LOW_AT, 15);
    servo->high = signed_at(table + LOW_AT + 2, 15);
    servo->most = table[VOLTS_AT];
    servo->least = table[VOLTS_AT + 1];
    servo->refused = !known ? "model" : MODE_AT && table[MODE_AT] ? "mode" : servo->least >= servo->most ? "memory" : 0;
    if (ENDLESS && servo->low >= servo->high) {
        servo->low = -MAX_POSITION;
        servo->high = MAX_POSITION;
    }
    if (servo->high - servo->low < limits[i].high - limits[i].low)
        servo->refused = "range";
}

/* Steps of whole turns that a servo, heard for the first time, counts less than its stored zero does; a winch that
   turns by less than a turn has one place for each. */
static int32_t find_base(uint8_t i, int32_t now) {
#ifdef TURN
    float middle = zeros[i] + (limits[i].low + limits[i].high) / 2.0f;
    return TURN * lroundf((middle - now) / TURN);
#else
    return (void)i, (void)now, 0;
#endif
}

/* A servo was switched off: one that counts turns begins again within one. */
static void forget(uint8_t i) {
    servos[i].on = 0;
    if (ENDLESS)
        zeroed = marked = 0;
    if (state != OFF)
        fault(RESTARTED, i);
}

/* Whether a servo that jumped may be believed: noise passes a sum now and then, but not twice. */
static uint8_t is_true(Servo *servo, uint8_t i, int32_t now) {
    if (servo->volts && labs(now - servo->place) > JUMP) {
        servo->jumped = !servo->jumped;
        if (servo->jumped)
            return 0;
        servo->place = now;
        forget(i);
    }
    servo->jumped = 0;
    return 1;
}

static void take_state(uint8_t i, uint8_t errors, const uint8_t *table) {
    Servo *servo = &servos[i];
    const uint8_t *told = table + STATE_AT - READ_AT;
    int32_t now = signed_at(told, 15), current = signed_at(told + CURRENT_AT, CURRENT_SIGN);
    uint8_t torque = table[TORQUE_AT - READ_AT];
    if (!servo->volts)
        servo->base = find_base(i, now);
    now += servo->base;
    if (!is_true(servo, i, now))
        return;
    servo->place = now;
    servo->age = 0;
    servo->errors = errors;
    servo->sags = errors & FAULT_SUPPLY ? servo->sags + (servo->sags < 2) : 0;
    servo->volts = told[6];
    servo->heat = told[7];
    motors[i].milliamps = lroundf(labs(current) * MILLIAMPERES);
    motors[i].pays = current < 0;
    servo->taken = LOCK_AT && !table[LOCK_AT - READ_AT]                    ? NOTHING
                   : word_at(table + BOUND_AT - READ_AT) != share_of(i) ? LOCKED
                   : !torque                                            ? BOUNDED
                                                                        : POWERED;
    if (servo->taken == POWERED || !is_armed)
        servo->delay = 0;
    if (is_on && torque)
        servo->on = 1;
    else if (servo->on && !torque && !errors)
        forget(i);
}

/* Look for the answer among all that came: the own echo, and answers of others, have another number or length. */
static void hear_answer(uint8_t i, uint8_t size) {
    static uint8_t came[320];
    uint16_t count = 0;
    for (int byte; (byte = hear_line()) >= 0;)
        if (count < sizeof came)
            came[count++] = byte;
    for (uint16_t at = 0; size && at + 6 + size <= count; at++) {
        const uint8_t *found = came + at;
        if (found[0] != 0xFF || found[1] != 0xFF || found[2] != i + 1 || found[3] != size + 2)
            continue;
        if (sum_up(found + 2, size + 3) != found[5 + size])
            continue;
        if (size == HEAD_BYTES)
            take_head(i, found + 5);
        else
            take_state(i, found[4], found + 5);
        return;
    }
}

/* Whether it is a servo for the smaller of two supplies. */
static uint8_t is_small(const Servo *servo) {
    int most = servo->most;
    return most <= SMALL_LIMIT;
}

/* Why a servo cannot be armed, 0 for nothing. */
static const char *find_refusal(const Servo *servo) {
    int volts = servo->volts, small = is_small(servo);
    if (servo->refused)
        return servo->refused;
    if (!volts || servo->age > LATE)
        return "servo";
    if (volts > servo->most || volts > (small ? SMALL_MOST : LARGE_MOST) || volts < servo->least ||
        (!small && volts < LARGE_LEAST) || small != is_small(servos))
        return "voltage";
    return servo->errors || servo->heat > MAX_HEAT ? "fault" : 0;
}

/* Reason why no motor may be armed, with the number of the servo; 0 for none. */
static const char *find_obstacle(void) {
    static char text[16];
    for (uint8_t i = 0; i < COUNT; i++) {
        const char *why = find_refusal(&servos[i]);
        if (!why)
            continue;
        strcpy(text, why);
        strcat(text, " ");
        utoa(i + 1, text + strlen(text), 10);
        return text;
    }
    return drained || is_supply_low() ? "supply" : 0;
}

static void watch_supply(void) {
    uint8_t least = 255;
    for (uint8_t i = 0; i < COUNT; i++)
        if (servos[i].volts < least)
            least = servos[i].volts;
    supply = 100 * least;
    sagging = is_supply_low() ? sagging + (sagging < RATE) : 0;
    if (sagging >= RATE / 2 && (state == ARMED || state == SILENT)) {
        drained = 1;
        fault(SAGGED, 0);
    }
}

/* All that goes over the line in a tick. */
static void measure(void) {
    static uint8_t turn, asked, waited = GOAL_TICKS;
    hear_answer(turn, asked);
    for (uint8_t i = 0; i < COUNT; i++) {
        servos[i].age += servos[i].age < 255;
        servos[i].delay += servos[i].delay < 255;
    }
    watch_supply();
    uint8_t armed = state == ARMED || state == SILENT;
    if (armed != is_armed) {
        for (uint8_t i = 0; i < COUNT; i++)
            servos[i].on = servos[i].taken = servos[i].delay = 0;
        is_armed = armed;
        waited = GOAL_TICKS;
    }
    if (++waited >= GOAL_TICKS) {
        waited = 0;
        write_switches();
    }
    turn = turn + 1 < COUNT ? turn + 1 : 0;
    asked = servos[turn].low >= servos[turn].high || servos[turn].refused ? HEAD_BYTES : READ_BYTES;
    begin_packet(turn + 1, TO_READ);
    add(asked == HEAD_BYTES ? 0 : READ_AT);
    add(asked);
    send_packet();
}
