/* The kernel of linear loops in C: the yardstick of loops beyond the paper's.
 *
 * It executes the same program over the same step matrices as `rthm_core.engine.kernel.run`. Numbers of states,
 * actuators and columns are known when it is compiled: N1, N2, M, WIDTH1 and WIDTH2.
 */
#include <stdint.h>
#include <string.h>

enum { n1 = N1, n2 = N2, m = M };

typedef struct {
    int64_t count, passes, rows;              /* operations of a pass, passes, rows at most */
    int64_t motor, reference, sample, output; /* codes of the operations */
    int64_t s_mask, r_mask;
    const int64_t *what, *plant_at, *numerical_at, *sample_back, *reference_back;
    const double *plant_step, *numerical_step, *sample_row, *plant_row, *numerical_row, *reference_row;
    const double *bias, *k_tot;
    double *samples, *references, *state1, *command, *state2, *held;
    double *plant_out, *numerical_out, *reference_out;
} Twin;

static inline __attribute__((always_inline)) void see(const double *matrix, int64_t k, const double *state,
                                                      const int n, const double *held, const int inputs,
                                                      double *out, const int outputs) {
    const double *row = matrix + k * (n + inputs) * outputs;
    double sum[outputs];
    for (int i = 0; i < outputs; i++) sum[i] = 0.0;
    for (int j = 0; j < n; j++, row += outputs)
        for (int i = 0; i < outputs; i++) sum[i] += row[i] * state[j];
    for (int j = 0; j < inputs; j++, row += outputs)
        for (int i = 0; i < outputs; i++) sum[i] += row[i] * held[j];
    memcpy(out, sum, outputs * sizeof *out);
}

long run(Twin *t) {
    int64_t s = 0, r = 0, row = 0;
    for (int64_t p = 0; p < t->passes; p++) {
        const int64_t later = p ? t->count : 0;
        for (int64_t e = 0; e < t->count; e++) {
            const int64_t kind = t->what[e], k1 = t->plant_at[later + e], k2 = t->numerical_at[later + e];
            if (kind == t->output) {
                see(t->plant_row, k1, t->state1, n1, t->command, m, t->plant_out + row * WIDTH1, WIDTH1);
                see(t->numerical_row, k2, t->state2, n2, t->held, 2 * m, t->numerical_out + row * WIDTH2,
                    WIDTH2);
                const double *in_use = t->references + ((r - t->reference_back[e]) & t->r_mask) * m;
                memcpy(t->reference_out + row * m, in_use, m * sizeof *in_use);
                if (++row == t->rows) return row;
                continue;
            }
            if (kind == t->sample) {
                double *new = t->samples + (s++ & t->s_mask) * 2 * m;
                see(t->sample_row, k1, t->state1, n1, t->command, m, new, 2 * m);
                for (int i = 0; i < 2 * m; i++) new[i] += t->bias[i];
                continue;
            }
            const double *used = t->samples + ((s - t->sample_back[e]) & t->s_mask) * 2 * m;
            const double *asked = t->references + ((r - t->reference_back[e]) & t->r_mask) * m;
            if (k1 >= 0) see(t->plant_step, k1, t->state1, n1, t->command, m, t->state1, n1);
            if (k2 >= 0) see(t->numerical_step, k2, t->state2, n2, t->held, 2 * m, t->state2, n2);
            if (kind == t->reference) {
                memcpy(t->held, used, 2 * m * sizeof *used);
                see(t->reference_row, 0, t->state2, n2, t->held, 2 * m, t->references + (r++ & t->r_mask) * m, m);
            } else if (kind == t->motor)
                for (int i = 0; i < m; i++) t->command[i] = used[i] + asked[i] / t->k_tot[i];
        }
    }
    return row;
}
