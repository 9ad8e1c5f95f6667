/* The loop of two masses as an event engine: what hand-written C gives, and the yardstick of the benchmark.
 *
 * One event after the other, in the order of the contract; exact steps between them, in closed form for the two
 * modes, kept for lengths that came before. A row every `step` ns: x1, v1, x2, v2, F_d in use, F. Delays are
 * constant and h(s) = 1.
 */
#include <math.h>
#include <stdint.h>

typedef int64_t ns;
typedef struct {
    double m1, c1, k1, k_tot, m2, c2, k2, c3, k3, x1, v1, x2, v2;
    ns td1, td2, td3, tau1, tau2, tau3, tau4;
} Loop;

enum { KEPT = 32, RING = 256 };
static const ns NEVER = (ns)1 << 62;

typedef struct {
    double stiffness, damping, mass;
    int kept;
    ns length[KEPT];
    double e[KEPT][4];
} Mode;

static const double *step_matrix(Mode *mode, ns length) {
    for (int i = 0; i < mode->kept; i++)
        if (mode->length[i] == length) return mode->e[i];
    int i = mode->kept < KEPT ? mode->kept++ : KEPT - 1;
    double t = length * 1e-9, a = 0.5 * mode->damping / mode->mass, w2 = mode->stiffness / mode->mass;
    double q = w2 - a * a, w = sqrt(fabs(q)), decay = exp(-a * t);
    double c = q > 0 ? cos(w * t) : cosh(w * t), s = q > 0 ? sin(w * t) / w : w > 0 ? sinh(w * t) / w : t;
    double *e = mode->e[i];
    e[0] = decay * (c + a * s), e[1] = decay * s, e[2] = -w2 * decay * s, e[3] = decay * (c - a * s);
    mode->length[i] = length;
    return e;
}

static inline void advance(Mode *mode, double *x, double *v, double rest, ns length) {
    if (length == 0) return;
    const double *e = step_matrix(mode, length);
    double d = *x - rest, x1 = rest + e[0] * d + e[1] * *v, v1 = e[2] * d + e[3] * *v;
    *x = x1, *v = v1;
}

static inline ns least(ns a, ns b) { return a < b ? a : b; }

long run(const Loop *p, ns end, ns step, double *out) {
    Mode one = {.stiffness = p->k1 + p->k_tot, .damping = p->c1, .mass = p->m1};
    Mode two = {.stiffness = p->k3 + p->k2, .damping = p->c3 + p->c2, .mass = p->m2};
    double x1 = p->x1, v1 = p->v1, x2 = p->x2, v2 = p->v2;
    double sample[RING][2], reference[RING], command[RING];
    ns reference_due[RING], command_due[RING];
    double force = -p->c2 * (v1 - v2) - p->k2 * (x1 - x2), cancelled = x1, hx = x1, hv = v1;
    double u = x1 + force / p->k_tot;
    double rest1 = p->k_tot * u / one.stiffness, rest2 = (p->c2 * hv + p->k2 * hx) / two.stiffness;
    ns t1 = 0, t2 = 0, next1 = 0, next2 = 0, next3 = 0, row = 0, count1 = 0;
    unsigned r_in = 0, r_out = 0, c_in = 0, c_out = 0;
    double *o = out;
    for (;;) {
        ns due_r = r_in != r_out ? reference_due[r_out % RING] : NEVER;
        ns due_c = c_in != c_out ? command_due[c_out % RING] : NEVER;
        ns t = least(least(least(next1, next2), least(next3, row)), least(due_r, due_c));
        if (t > end) break;
        if (due_c == t) {
            advance(&one, &x1, &v1, rest1, t - t1), t1 = t;
            u = command[c_out++ % RING], rest1 = p->k_tot * u / one.stiffness;
        }
        int changed = 0;
        if (due_r == t) force = reference[r_out++ % RING], changed = 1;
        if (next1 == t) {
            advance(&one, &x1, &v1, rest1, t - t1), t1 = t;
            sample[count1 % RING][0] = x1, sample[count1 % RING][1] = v1, count1++, next1 += p->td1;
        }
        if (next2 == t) {
            advance(&two, &x2, &v2, rest2, t - t2), t2 = t;
            ns k = t >= p->tau2 ? (t - p->tau2) / p->td1 : -1;
            hx = k >= 0 ? sample[k % RING][0] : p->x1, hv = k >= 0 ? sample[k % RING][1] : p->v1;
            rest2 = (p->c2 * hv + p->k2 * hx) / two.stiffness;
            double f = -p->c2 * (hv - v2) - p->k2 * (hx - x2);
            if (p->tau3 == 0) force = f, changed = 1;
            else reference[r_in % RING] = f, reference_due[r_in++ % RING] = t + p->tau3;
            next2 += p->td2;
        }
        if (next3 == t) {
            ns k = t >= p->tau1 ? (t - p->tau1) / p->td1 : -1;
            cancelled = k >= 0 ? sample[k % RING][0] : p->x1;
            next3 += p->td3, changed = 1;
        }
        if (changed) {
            double given = cancelled + force / p->k_tot;
            if (p->tau4 == 0) {
                advance(&one, &x1, &v1, rest1, t - t1), t1 = t;
                u = given, rest1 = p->k_tot * u / one.stiffness;
            } else command[c_in % RING] = given, command_due[c_in++ % RING] = t + p->tau4;
        }
        if (row == t) {
            advance(&one, &x1, &v1, rest1, t - t1), t1 = t;
            advance(&two, &x2, &v2, rest2, t - t2), t2 = t;
            o[0] = x1, o[1] = v1, o[2] = x2, o[3] = v2, o[4] = force, o[5] = p->k_tot * (u - x1), o += 6;
            row += step;
        }
    }
    return (o - out) / 6;
}
