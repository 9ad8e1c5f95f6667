/* The device's side of the protocol of docs/udp.md, for a microcontroller: C99, no operating system, no memory
   of its own. The firmware gives it packets and its clock, and reads what the motors are to do. */
#ifndef UDP_DEVICE_H
#define UDP_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DEVICE_DOFS 1      /* n */
#define DEVICE_ACTUATORS 1 /* m */
#define DEVICE_PORT 9750
#define DEVICE_HEAD 32
#define DEVICE_REQUEST_SIZE (DEVICE_HEAD + 8 * DEVICE_ACTUATORS)
#define DEVICE_STATE_SIZE (DEVICE_HEAD + 16 * (DEVICE_DOFS + DEVICE_ACTUATORS))

/* Flags of a state. */
enum { DEVICE_ARMED = 1, DEVICE_OLD = 2, DEVICE_FAR = 4, DEVICE_BAD = 8 };

struct device_limits {
    double command;       /* largest command, m */
    double rate;          /* largest rate, m/s */
    double start;         /* largest distance of the first command from the motors, m */
    uint32_t command_age; /* longest age of a command, and longest time without one, us */
    uint32_t period;      /* longest time that counts for the rate, us */
};

struct device_sensors {
    double position[DEVICE_DOFS], velocity[DEVICE_DOFS];      /* m, m/s */
    double motor[DEVICE_ACTUATORS], force[DEVICE_ACTUATORS];  /* m, N */
};

struct device {
    struct device_limits limits;
    void (*read)(struct device_sensors *sensors); /* reads all sensors now */
    bool armed;                                   /* whether the motors are under command; else they hold */
    double command[DEVICE_ACTUATORS];             /* what they are to do while armed, m */
    uint32_t session, heard, number, fresh;
};

/* Take a packet at `now` (us of any clock that wraps around at 32 bits). Returns the size of the answer, 0 where
   none is owed; `answer` has room for DEVICE_STATE_SIZE bytes. */
size_t device_receive(struct device *device, const uint8_t *packet, size_t size, uint32_t now, uint8_t *answer);

/* Hold where no fresh command has come for too long; call it at least every millisecond. Returns whether that is
   found now. */
bool device_watch(struct device *device, uint32_t now);

#endif
