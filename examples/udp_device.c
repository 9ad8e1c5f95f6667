/* The device's side of the protocol of docs/udp.md; see udp_device.h. No call of an operating system, no heap.
   `double` has to have 64 bits. */
#include "udp_device.h"

#include <math.h>
#include <string.h>

typedef char double_has_64_bits[sizeof(double) == 8 ? 1 : -1];

enum { VERSION = 1, REQUEST = 1, STATE = 2, COMMANDS = 1 };

static uint32_t get32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put32(uint8_t *at, uint32_t value)
{
    for (int k = 0; k < 4; k++) at[k] = (uint8_t)(value >> 8 * k);
}

static double get_double(const uint8_t *at)
{
    uint64_t bits = (uint64_t)get32(at) | (uint64_t)get32(at + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint8_t *put_doubles(uint8_t *at, const double *values, int count)
{
    for (int k = 0; k < count; k++, at += 8) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        put32(at, (uint32_t)bits);
        put32(at + 4, (uint32_t)(bits >> 32));
    }
    return at;
}

static bool is_request(const uint8_t *packet, size_t size)
{
    return size == DEVICE_REQUEST_SIZE && memcmp(packet, "RTHM", 4) == 0 && packet[4] == VERSION
        && packet[5] == REQUEST && packet[6] == DEVICE_DOFS && packet[7] == DEVICE_ACTUATORS;
}

/* Whether a request goes on with the session, or begins one while nobody commands the motors. */
static bool continues(struct device *device, uint32_t session, uint32_t number)
{
    if (session != device->session) {
        if (device->armed) return false;
        device->session = session;
    } else if (number == device->heard || number - device->heard >= UINT32_C(0x80000000)) {
        return false;
    }
    device->heard = number;
    return true;
}

/* Execute a command as far as is allowed; 0, or the flag that says why not. */
static uint32_t obey(struct device *device, const uint8_t *packet, const double *motor, uint32_t now)
{
    const struct device_limits *limits = &device->limits;
    double command[DEVICE_ACTUATORS];
    if (now - get32(packet + 20) > limits->command_age) return DEVICE_OLD;
    for (int k = 0; k < DEVICE_ACTUATORS; k++) {
        command[k] = get_double(packet + DEVICE_HEAD + 8 * k);
        if (!(fabs(command[k]) <= limits->command)) return DEVICE_BAD; /* true for a NaN, too */
    }
    for (int k = 0; k < DEVICE_ACTUATORS && !device->armed; k++)
        if (!(fabs(command[k] - motor[k]) <= limits->start)) return DEVICE_FAR;
    uint32_t passed = device->armed ? now - device->fresh : limits->period;
    double step = limits->rate * (passed < limits->period ? passed : limits->period) * 1e-6;
    for (int k = 0; k < DEVICE_ACTUATORS; k++) {
        double last = device->armed ? device->command[k] : motor[k];
        device->command[k] = last + fmin(fmax(command[k] - last, -step), step);
    }
    device->armed = true;
    device->fresh = now;
    return 0;
}

static size_t state(struct device *device, const struct device_sensors *read, uint32_t flags, uint32_t now,
                    uint8_t *answer)
{
    const uint8_t head[8] = {'R', 'T', 'H', 'M', VERSION, STATE, DEVICE_DOFS, DEVICE_ACTUATORS};
    memcpy(answer, head, sizeof head);
    device->number = device->number == UINT32_MAX ? 1 : device->number + 1;
    const uint32_t words[6] = {device->session, device->number, device->heard, now, flags, 0};
    for (int k = 0; k < 6; k++) put32(answer + 8 + 4 * k, words[k]);
    uint8_t *at = put_doubles(answer + DEVICE_HEAD, read->position, DEVICE_DOFS);
    at = put_doubles(at, read->velocity, DEVICE_DOFS);
    at = put_doubles(at, read->motor, DEVICE_ACTUATORS);
    at = put_doubles(at, read->force, DEVICE_ACTUATORS);
    return (size_t)(at - answer);
}

bool device_watch(struct device *device, uint32_t now)
{
    if (!device->armed || now - device->fresh <= device->limits.command_age) return false;
    device->armed = false;
    return true;
}

size_t device_receive(struct device *device, const uint8_t *packet, size_t size, uint32_t now, uint8_t *answer)
{
    device_watch(device, now);
    if (!is_request(packet, size) || !continues(device, get32(packet + 8), get32(packet + 12))) return 0;
    struct device_sensors sensors;
    device->read(&sensors);
    uint32_t refused = get32(packet + 24) & COMMANDS ? obey(device, packet, sensors.motor, now) : 0;
    return state(device, &sensors, refused | (device->armed ? DEVICE_ARMED : 0), now, answer);
}
