/* A DC motor with gear, encoder, spool and cable. Oracle: equations of a brushed motor; they know nothing of firmware.

   Units: counts of the encoder [1], s, A, V. 12 V, 3600 counts/s without load, 2 A at stall, 20 ms to speed. */
#pragma once
#include <math.h>

typedef struct {
    int duty, control, bit, port, direction, adc; /* addresses in memory, or pins */
    char encoder;
    int channel, block; /* block: the shaft is held fast */
    double angle, speed, current, stiffness, slack, wire, fastest, least, most;
    int cut; /* 1: the encoder's cable is cut; 2: the wire of its second channel is; 3: its channels are swapped */
} Plant;

static void turn_plant(Plant *plant, double volts, double dt) {
    const double volts_by_speed = 12.0 / 3600, rise = 3600 / (0.02 * 2);
    plant->current = (volts - volts_by_speed * plant->speed) / (6 + plant->wire);
    double pull = plant->stiffness * fmax(0, plant->angle - plant->slack); /* in amperes of the motor */
    double force = plant->current - pull, friction = 0.05;
    if (plant->speed == 0 && fabs(force) < friction)
        force = 0;
    else
        force -= copysign(friction, plant->speed != 0 ? plant->speed : force);
    double before = plant->speed;
    plant->speed += dt * rise * force;
    if (before * plant->speed < 0 || plant->block)
        plant->speed = 0;
    plant->angle += dt * plant->speed;
    plant->fastest = fmax(plant->fastest, fabs(plant->speed));
    plant->least = fmin(plant->least, plant->angle);
    plant->most = fmax(plant->most, plant->angle);
}

/* Both channels of its encoder, bit 0 is A. */
static int phase_of(const Plant *plant) {
    static const int gray[4] = {0, 1, 3, 2};
    return gray[(int)floor(plant->cut == 3 ? -plant->angle : plant->angle) & 3];
}
