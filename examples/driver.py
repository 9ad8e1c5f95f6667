"""A driver: its rig is a mass that follows the motor like a filter of first order. driver.py SPEC"""

import sys

from rthm_plant_sim.driver import drive


class Rig:
    x = u = 0.1  # m

    def read(self):
        v = (self.u - self.x) / 0.05
        self.x += v * 0.0012
        return self.x, v, self.u, 40.0 * (self.u - self.x)  # position, velocity, motor, force

    def command(self, u):
        self.u = u[0]


sys.exit(drive(Rig(), sys.argv[1]))
