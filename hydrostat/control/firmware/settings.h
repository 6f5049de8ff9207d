/* What one robot needs: `hydrostat firmware` writes this file anew. These are two winches on an Uno, for trying. */
#define ROBOT "trial"
#define DCS 2    /* geared DC motors with encoders: the first of all motors */
#define SERVOS 0 /* hobby servos: the last */
#define DEADLINE_MS 200
#define FREE_SPEED 3600 /* of a DC motor without load [1/s] */
/* least and greatest place, greatest speed [1/s], acceleration [1/s2], sign of the encoder, greatest current [mA].
   A place is a count of the encoder, or a microsecond of a servo's pulse. */
#define MOTORS { \
    {-200, 4000, 3000, 20000, 1, 1500}, \
    {-200, 4000, 3000, 20000, 1, 1500}, \
}
