/* One configuration followed by itself: each product and sum of lanes.h, so the same digits, without seven idle lanes.

   The lanes are here the three entries of a column of the frame (and one that is idle), four joints whose sines and
   cosines are worked out at a time, and the joints of a row of the Jacobian. Included by lanes.h.
*/

/* Joints by fours. */
#define ROW_JOINTS ((MOST_JOINTS + 3) / 4 * 4)

typedef struct {
    double s[ROW_JOINTS], c[ROW_JOINTS];
    Part v[4]; /* x, y, z, p */
} Row;

static inline void row_prepared(const Chain *chain, const double *q, Row *row) {
    int n = chain->n;
    for (int i = 0; i < n; i++)
        row->s[i] = q[i] + chain->offsets[i];
    for (int i = n; i % 4; i++)
        row->s[i] = 0.0;
    for (int first = 0; first < n; first += 4) {
        Part x = *(const Part *)(row->s + first), sine, cosine;
        sine_cosine(x, &sine, &cosine);
        /* What is left of joints that slide, and of angles that are far or no numbers. */
        int kept = 0;
        for (int i = first; i < first + 4 && i < n; i++)
            kept |= !chain->revolute[i] | !(fabs(row->s[i]) <= FARTHEST);
        *(Part *)(row->c + first) = cosine;
        if (!kept) {
            *(Part *)(row->s + first) = sine;
            continue;
        }
        for (int i = first; i < first + 4 && i < n; i++) {
            int far = !(fabs(x[i - first]) <= FARTHEST);
            if (!chain->revolute[i])
                continue;
            row->s[i] = far ? sin(x[i - first]) : sine[i - first];
            row->c[i] = far ? cos(x[i - first]) : cosine[i - first];
        }
    }
    for (int k = 0; k < 4; k++) {
        const double *from = chain->first + 3 * k;
        row->v[k] = (Part){from[0], from[1], from[2], 0.0};
    }
}

/* A column of F C: what zeros of C spare is left out. */
static inline Part row_column(const double *m, Part x, Part y, Part z) {
    Part out = {0.0, 0.0, 0.0, 0.0};
    int begun = 0;
    if (m[0] != 0.0) {
        out = m[0] * x;
        begun = 1;
    }
    if (m[1] != 0.0) {
        out = begun ? out + m[1] * y : m[1] * y;
        begun = 1;
    }
    if (m[2] != 0.0)
        out = begun ? out + m[2] * z : m[2] * z;
    return out;
}

/* Along joint i and the constant after it: `turn` or `slide`, and `go_on`. */
static inline void row_moved(const Chain *chain, int i, Row *row) {
    const Constant *C = &chain->links[i];
    double s = row->s[i], c = row->c[i];
    Part x = row->v[0], y = row->v[1], z = row->v[2], p = row->v[3];
    if (chain->revolute[i]) {
        Part before = x;
        x = c * before + s * y;
        y = c * y - s * before;
    } else {
        p += s * z;
    }
    if (C->shifts) {
        if (C->m[9] != 0.0)
            p += C->m[9] * x;
        if (C->m[10] != 0.0)
            p += C->m[10] * y;
        if (C->m[11] != 0.0)
            p += C->m[11] * z;
    }
    row->v[3] = p;
    if (C->turns) {
        row->v[0] = row_column(C->m, x, y, z);
        row->v[1] = row_column(C->m + 3, x, y, z);
        row->v[2] = row_column(C->m + 6, x, y, z);
    } else {
        row->v[0] = x;
        row->v[1] = y;
    }
}

static void row_pose(const Chain *chain, const double *q, double *out) {
    Row row;
    row_prepared(chain, q, &row);
    for (int i = 0; i < chain->n; i++)
        row_moved(chain, i, &row);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            out[4 * r + c] = row.v[c][r];
    out[12] = out[13] = out[14] = 0.0;
    out[15] = 1.0;
}

/* The Jacobian (6, n) in the base's axes, lengths as they are: `column` for size 1. */
static void row_jacobian(const Chain *chain, const double *q, double *out) {
    Row row;
    double z[3][ROW_JOINTS], o[3][ROW_JOINTS], J[3][ROW_JOINTS];
    int n = chain->n;
    row_prepared(chain, q, &row);
    for (int i = 0; i < n; i++) {
        for (int r = 0; r < 3; r++) {
            z[r][i] = row.v[2][r];
            o[r][i] = row.v[3][r];
        }
        row_moved(chain, i, &row);
    }
    for (int i = n; i % 4; i++)
        for (int r = 0; r < 3; r++)
            z[r][i] = o[r][i] = 0.0;
    for (int i = 0; i < n; i += 4) {
        Part axis[3], lever[3];
        for (int r = 0; r < 3; r++) {
            axis[r] = *(const Part *)(z[r] + i);
            lever[r] = row.v[3][r] - *(const Part *)(o[r] + i);
        }
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            *(Part *)(J[r] + i) = axis[a] * lever[b] - axis[b] * lever[a];
        }
    }
    for (int r = 0; r < 3; r++)
        for (int i = 0; i < n; i++) {
            out[r * n + i] = J[r][i];
            out[(3 + r) * n + i] = z[r][i];
        }
    for (int i = 0; i < n; i++)
        if (!chain->revolute[i])
            for (int r = 0; r < 3; r++) {
                out[r * n + i] = z[r][i];
                out[(3 + r) * n + i] = 0.0;
            }
}
