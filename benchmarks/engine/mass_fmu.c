/* A mass between springs as an FMI 2.0 co-simulation unit: x'' = a0 x + a1 v + b0 in0 + b1 in1.
 *
 * Real variables by value reference: 0 a0, 1 a1, 2 b0, 3 b1, 4 in0, 5 in1, 6 x, 7 v. A step is exact.
 */
#include <math.h>
#include <stdlib.h>

typedef void *Component;
typedef struct { double value[8]; } Mass;

Component fmi2Instantiate(const char *a, int b, const char *c, const char *d, const void *e, int f, int g) {
    return calloc(1, sizeof(Mass));
}
void fmi2FreeInstance(Component c) { free(c); }
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(Component c, int on, size_t n, const char *const categories[]) { return 0; }
int fmi2SetupExperiment(Component c, int a, double b, double d, int e, double f) { return 0; }
int fmi2EnterInitializationMode(Component c) { return 0; }
int fmi2ExitInitializationMode(Component c) { return 0; }
int fmi2Terminate(Component c) { return 0; }
int fmi2Reset(Component c) { return 0; }
int fmi2SetReal(Component c, const unsigned *which, size_t n, const double *value) {
    for (size_t i = 0; i < n; i++) ((Mass *)c)->value[which[i]] = value[i];
    return 0;
}
int fmi2GetReal(Component c, const unsigned *which, size_t n, double *value) {
    for (size_t i = 0; i < n; i++) value[i] = ((Mass *)c)->value[which[i]];
    return 0;
}
#define ABSENT(name) int name(void) { return 3; }
ABSENT(fmi2GetInteger) ABSENT(fmi2GetBoolean) ABSENT(fmi2GetString)
ABSENT(fmi2SetInteger) ABSENT(fmi2SetBoolean) ABSENT(fmi2SetString)
ABSENT(fmi2GetFMUstate) ABSENT(fmi2SetFMUstate) ABSENT(fmi2FreeFMUstate) ABSENT(fmi2SerializedFMUstateSize)
ABSENT(fmi2SerializeFMUstate) ABSENT(fmi2DeSerializeFMUstate) ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2SetRealInputDerivatives) ABSENT(fmi2GetRealOutputDerivatives) ABSENT(fmi2CancelStep)
ABSENT(fmi2GetStatus) ABSENT(fmi2GetRealStatus) ABSENT(fmi2GetIntegerStatus) ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetStringStatus)
int fmi2DoStep(Component c, double now, double h, int keep) {
    double *z = ((Mass *)c)->value, square = -z[0], decay = -0.5 * z[1];
    double w = sqrt(square - decay * decay), e = exp(-decay * h), cosine = cos(w * h), sine = sin(w * h) / w;
    double rest = (z[2] * z[4] + z[3] * z[5]) / square, d = z[6] - rest, v = z[7];
    z[6] = rest + e * ((cosine + decay * sine) * d + sine * v);
    z[7] = e * (-square * sine * d + (cosine - decay * sine) * v);
    return 0;
}
