/* One configuration followed by itself: each product and sum of lanes.h, so the same digits, without seven idle lanes.

   Sines and cosines of four joints are worked out at a time. Included by lanes.h.
*/

typedef struct {
    double s[MOST_JOINTS], c[MOST_JOINTS], v[12];
} Row;

static void row_prepared(const Chain *chain, const double *q, Row *row) {
    int n = chain->n;
    for (int i = 0; i < n; i++)
        row->s[i] = q[i] + chain->offsets[i];
    for (int first = 0; first < n; first += 4) {
        double x[4] = {0.0, 0.0, 0.0, 0.0};
        int count = n - first < 4 ? n - first : 4;
        Part sine, cosine;
        for (int l = 0; l < count; l++)
            x[l] = row->s[first + l];
        sine_cosine(*(Part *)x, &sine, &cosine);
        for (int l = 0; l < count; l++) {
            if (!chain->revolute[first + l])
                continue;
            int far = !(fabs(x[l]) <= FARTHEST);
            row->s[first + l] = far ? sin(x[l]) : sine[l];
            row->c[first + l] = far ? cos(x[l]) : cosine[l];
        }
    }
    for (int j = 0; j < 12; j++)
        row->v[j] = chain->first[j];
}

/* Along joint i and the constant after it: `turn` or `slide`, and `go_on`. */
static void row_moved(const Chain *chain, int i, Row *row) {
    const Constant *C = &chain->links[i];
    double *v = row->v, s = row->s[i], c = row->c[i], out[9];
    if (chain->revolute[i])
        for (int r = 0; r < 3; r++) {
            double x = v[r], y = v[3 + r];
            v[r] = c * x + s * y;
            v[3 + r] = c * y - s * x;
        }
    else
        for (int r = 0; r < 3; r++)
            v[9 + r] += s * v[6 + r];
    if (C->shifts)
        for (int j = 0; j < 3; j++)
            if (C->m[9 + j] != 0.0)
                for (int r = 0; r < 3; r++)
                    v[9 + r] += C->m[9 + j] * v[3 * j + r];
    if (!C->turns)
        return;
    for (int k = 0; k < 3; k++)
        for (int r = 0; r < 3; r++) {
            int begun = 0;
            out[3 * k + r] = 0.0;
            for (int j = 0; j < 3; j++) {
                double m = C->m[3 * k + j];
                if (m == 0.0)
                    continue;
                out[3 * k + r] = begun ? out[3 * k + r] + m * v[3 * j + r] : m * v[3 * j + r];
                begun = 1;
            }
        }
    for (int j = 0; j < 9; j++)
        v[j] = out[j];
}

static void row_put(const Row *row, double *out) {
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            out[4 * r + c] = row->v[3 * c + r];
    out[12] = out[13] = out[14] = 0.0;
    out[15] = 1.0;
}

static void row_pose(const Chain *chain, const double *q, double *out) {
    Row row;
    row_prepared(chain, q, &row);
    for (int i = 0; i < chain->n; i++)
        row_moved(chain, i, &row);
    row_put(&row, out);
}

/* The Jacobian (6, n) in the base's axes, lengths as they are: `column` for size 1. */
static void row_jacobian(const Chain *chain, const double *q, double *out) {
    Row row;
    double axes[MOST_JOINTS][6];
    int n = chain->n;
    row_prepared(chain, q, &row);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < 6; j++)
            axes[i][j] = row.v[6 + j];
        row_moved(chain, i, &row);
    }
    for (int i = 0; i < n; i++)
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            double *z = axes[i], one = row.v[9 + a] - z[3 + a], other = row.v[9 + b] - z[3 + b];
            out[r * n + i] = chain->revolute[i] ? z[a] * other - z[b] * one : z[r];
            out[(3 + r) * n + i] = chain->revolute[i] ? z[r] : 0.0;
        }
}
