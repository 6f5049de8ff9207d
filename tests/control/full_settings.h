/* A Mega with all the motors that it bears, for tests. */
#define ROBOT "full"
#define DCS 6
#define SERVOS 8
#define DEADLINE_MS 200
#define FREE_SPEED 3600
#define WINCH {-200, 4000, 3000, 20000, 1, 1500}
#define SERVO {1000, 2000, 1000, 10000, 1, 1}
#define MOTORS {WINCH, WINCH, WINCH, WINCH, WINCH, WINCH, SERVO, SERVO, SERVO, SERVO, SERVO, SERVO, SERVO, SERVO}
