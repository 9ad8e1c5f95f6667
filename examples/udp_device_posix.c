/* udp_device.c on a computer instead of a microcontroller. Its rig is a mass that follows the motor like a filter
   of first order, behind a wire of 40 N/m; it stands at the position that it is given.

   cc -std=c99 -O2 -o udp_device udp_device.c udp_device_posix.c -lm
   ./udp_device [PORT [METRES]] */
#define _POSIX_C_SOURCE 200112L
#include "udp_device.h"

#include <arpa/inet.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>

static double x, u;
static uint32_t moved;

static uint32_t clock_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)((uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u);
}

static void read_sensors(struct device_sensors *sensors)
{
    uint32_t now = clock_us();
    x += (u - x) * (1.0 - exp((now - moved) * -1e-6 / 0.05));
    moved = now;
    sensors->position[0] = x;
    sensors->velocity[0] = (u - x) / 0.05;
    sensors->motor[0] = u;
    sensors->force[0] = 40.0 * (u - x);
}

int main(int count, char **arguments)
{
    struct device device = {.limits = {1.0, 5.0, 0.02, 500000, 4000}, .read = read_sensors};
    struct sockaddr_in own = {.sin_family = AF_INET}, from;
    struct timeval look = {0, 1000};
    struct sched_param real_time = {.sched_priority = 60};
    uint8_t packet[2048], answer[DEVICE_STATE_SIZE];
    int ear = socket(AF_INET, SOCK_DGRAM, 0);

    own.sin_port = htons((uint16_t)(count > 1 ? atoi(arguments[1]) : DEVICE_PORT));
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    x = u = count > 2 ? atof(arguments[2]) : 0.0;
    moved = clock_us();
    sched_setscheduler(0, SCHED_FIFO, &real_time); /* where the system grants it */
    setsockopt(ear, SOL_SOCKET, SO_RCVTIMEO, &look, sizeof look);
    if (bind(ear, (struct sockaddr *)&own, sizeof own) != 0) {
        perror("udp_device");
        return 2;
    }
    printf("device at 127.0.0.1:%d\n", ntohs(own.sin_port));
    fflush(stdout);
    for (;;) {
        socklen_t length = sizeof from;
        ssize_t size = recvfrom(ear, packet, sizeof packet, 0, (struct sockaddr *)&from, &length);
        if (device_watch(&device, clock_us())) {
            printf("no fresh command: the motors hold\n");
            fflush(stdout);
        }
        if (size <= 0) continue;
        size_t owed = device_receive(&device, packet, (size_t)size, clock_us(), answer);
        if (device.armed) u = device.command[0];
        if (owed) sendto(ear, answer, owed, 0, (struct sockaddr *)&from, length);
    }
}
