/* Ways of LANES configurations that have the position of their targets to where they are least turned from these.

   Python's `turn_in_place` is the reference, and says what is derived how. Comes after ways_down.h.
*/

/* See `turn_in_place`; RANKED is `ranks.RANK`. */
#define TURN_LONGEST 0.3
#define TURN_SHORTEST 1e-9
#define TURN_BACK 3
#define TURN_FLAT 1e-9
#define TURN_HAS_POSITION 1e-11
#define TURN_RANK 1e-6

/* The rows of a lane's position Jacobian of the joints that are not held, made orthogonal: J = sum V_j w_j, with
   over_j = 1 / |w_j|^2, or 0 where that has no rank. */
typedef struct {
    double w[MOST_ROWS][MOST_ROWS], V[MOST_ROWS][MOST_ROWS], over[3];
} Rows;

static void rows_of(int n, const Moved *at, int l, const int held[MOST_MOVED], Rows *to) {
    for (int r = 0; r < 3; r++)
        for (int i = 0; i < n; i++)
            to->w[r][i] = held[i] ? 0.0 : at->J[i][r][l];
    jacobi(n, 3, to->w, to->V);
    for (int j = 0; j < 3; j++) {
        double squared = 0.0;
        for (int i = 0; i < n; i++)
            squared += to->w[j][i] * to->w[j][i];
        to->over[j] = sqrt(squared) > TURN_RANK ? 1.0 / squared : 0.0;
    }
}

/* The multipliers with which g + J' y is shortest. */
static void multipliers(int n, const Rows *rows, const double *g, double y[3]) {
    y[0] = y[1] = y[2] = 0.0;
    for (int j = 0; j < 3; j++) {
        double part = 0.0;
        for (int i = 0; i < n; i++)
            part += rows->w[j][i] * g[i];
        for (int r = 0; r < 3; r++)
            y[r] -= rows->V[j][r] * part * rows->over[j];
    }
}

/* v less its part in the rows, of the joints that are not held. */
static void projected(int n, const Rows *rows, const int held[MOST_MOVED], double *v) {
    double part[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < n; i++)
        v[i] = held[i] ? 0.0 : v[i];
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < n; i++)
            part[j] += rows->w[j][i] * v[i];
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < n; i++)
            v[i] -= rows->w[j][i] * (part[j] * rows->over[j]);
}

/* Eigenvectors, the rows of V, and eigenvalues, the diagonal that is left, of a symmetric A: cyclic Jacobi. */
static void symmetric_eigen(int n, double A[MOST_MOVED][MOST_MOVED], double V[MOST_MOVED][MOST_MOVED]) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            V[i][j] = i == j;
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double off = 0.0, whole = 0.0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                whole += A[i][j] * A[i][j];
                off += i == j ? 0.0 : A[i][j] * A[i][j];
            }
        if (!(off > 1e-32 * whole))
            return;
        for (int i = 0; i < n; i++)
            for (int j = i + 1; j < n; j++) {
                if (A[i][j] == 0.0)
                    continue;
                double zeta = (A[j][j] - A[i][i]) / (2.0 * A[i][j]), t = 1.0 / (fabs(zeta) + sqrt(1.0 + zeta * zeta));
                t = zeta < 0.0 ? -t : t;
                double c = 1.0 / sqrt(1.0 + t * t), s = c * t;
                for (int k = 0; k < n; k++) {
                    double u = A[k][i], v = A[k][j];
                    A[k][i] = c * u - s * v;
                    A[k][j] = s * u + c * v;
                }
                for (int k = 0; k < n; k++) {
                    double u = A[i][k], v = A[j][k];
                    A[i][k] = c * u - s * v;
                    A[j][k] = s * u + c * v;
                    u = V[i][k], v = V[j][k];
                    V[i][k] = c * u - s * v;
                    V[j][k] = s * u + c * v;
                }
            }
    }
}

/* What is kept of the ways of all lanes. */
typedef struct {
    Moved tools;
    double x[MOST_MOVED][LANES], low[MOST_MOVED][LANES], high[MOST_MOVED][LANES], W[12][LANES];
} Turning;

/* Newton's step of all lanes within the null space of the position's Jacobian: dx (n, LANES). */
static void turning_step(const Chain *chain, double size, Turning *at, double dx[MOST_MOVED][LANES]) {
    static const double one[LANES] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    double place[LANES], turn[LANES], y[3][LANES], g[MOST_MOVED][LANES], H[MOST_MOVED][MOST_MOVED][LANES];
    double A[MOST_MOVED][MOST_MOVED], V[MOST_MOVED][MOST_MOVED], slope[MOST_MOVED];
    int n = chain->n, held[LANES][MOST_MOVED];
    Rows rows[LANES];
    moved_tools(chain, at->x, at->W, size, &at->tools, place, turn);
    for (int l = 0; l < LANES; l++) {
        double own[MOST_MOVED], wish[3];
        for (int i = 0; i < n; i++) {
            own[i] = 0.0;
            for (int r = 0; r < 3; r++)
                own[i] += at->tools.J[i][3 + r][l] * at->tools.a[r][l];
            held[l][i] = at->x[i][l] <= at->low[i][l] || at->x[i][l] >= at->high[i][l];
        }
        for (int k = 0; k < 3; k++) {
            rows_of(n, &at->tools, l, held[l], &rows[l]);
            multipliers(n, &rows[l], own, wish);
            for (int i = 0; i < n && k < 2; i++) {
                double r = own[i];
                for (int j = 0; j < 3; j++)
                    r += at->tools.J[i][j][l] * wish[j];
                held[l][i] = (at->x[i][l] <= at->low[i][l] && r > 0.0) || (at->x[i][l] >= at->high[i][l] && r < 0.0);
            }
        }
        for (int r = 0; r < 3; r++)
            y[r][l] = wish[r];
    }
    /* With the target put to where the tool is off by the multipliers. */
    curved(n, &at->tools, y, one, g, H);
    for (int l = 0; l < LANES; l++) {
        double longest = TURN_LONGEST, step[MOST_MOVED];
        for (int i = 0; i < n; i++) {
            slope[i] = g[i][l];
            step[i] = 0.0;
            for (int j = 0; j < n; j++)
                A[i][j] = i < j ? H[i][j][l] : H[j][i][l];
        }
        projected(n, &rows[l], held[l], slope);
        for (int i = 0; i < n; i++)
            projected(n, &rows[l], held[l], A[i]);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                V[i][j] = A[j][i];
        for (int i = 0; i < n; i++)
            projected(n, &rows[l], held[l], V[i]);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                A[i][j] = 0.5 * (V[i][j] + V[j][i]);
        symmetric_eigen(n, A, V);
        for (int k = 0; k < n; k++) {
            double part = 0.0, curvature = fabs(A[k][k]) > TURN_FLAT ? fabs(A[k][k]) : TURN_FLAT;
            for (int i = 0; i < n; i++)
                part += V[k][i] * slope[i];
            for (int i = 0; i < n; i++)
                step[i] -= V[k][i] * (part / curvature);
        }
        for (int i = 0; i < n; i++)
            longest = fabs(step[i]) > longest ? fabs(step[i]) : longest;
        for (int i = 0; i < n; i++)
            dx[i][l] = step[i] * (TURN_LONGEST / longest);
    }
}

/* The lanes' x led back to the position within the limits. */
static void led_back(const Chain *chain, double size, Turning *at) {
    double place[LANES], turn[LANES];
    int n = chain->n, held[MOST_MOVED];
    Rows rows;
    for (int i = 0; i < n; i++)
        for (int l = 0; l < LANES; l++)
            at->x[i][l] = clipped(at->x[i][l], at->low[i][l], at->high[i][l]);
    for (int k = 0; k < TURN_BACK; k++) {
        moved_tools(chain, at->x, at->W, size, &at->tools, place, turn);
        for (int l = 0; l < LANES; l++) {
            for (int i = 0; i < n; i++) {
                double up = 0.0;
                for (int r = 0; r < 3; r++)
                    up += at->tools.J[i][r][l] * at->tools.e[r][l];
                held[i] = (at->x[i][l] <= at->low[i][l] && up > 0.0) || (at->x[i][l] >= at->high[i][l] && up < 0.0);
            }
            rows_of(n, &at->tools, l, held, &rows);
            for (int j = 0; j < 3; j++) {
                double part = 0.0;
                for (int r = 0; r < 3; r++)
                    part += rows.V[j][r] * at->tools.e[r][l];
                for (int i = 0; i < n; i++)
                    at->x[i][l] -= rows.w[j][i] * (part * rows.over[j]);
            }
            for (int i = 0; i < n; i++)
                at->x[i][l] = clipped(at->x[i][l], at->low[i][l], at->high[i][l]);
        }
    }
}

/* Ways from values x (m, n) [rad | size] that have the position of targets T (m, 12), within low and high (m, n).

   x becomes where they end, and left (m, 2) is half of the squared distance and 1 - cos of the angle there. */
void NAMED(turned)(const Chain *chain, const double *T, double *x, ptrdiff_t m, double size, const double *low,
                   const double *high, int steps, double *left) {
    Turning at;
    double here[MOST_MOVED][LANES], dx[MOST_MOVED][LANES], place[LANES], turn[LANES], now[2][LANES], trust[LANES];
    int n = chain->n, over[LANES];
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        int count = m - first < LANES ? (int)(m - first) : LANES, going = count;
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t from = first + (l < count ? l : count - 1);
            for (int j = 0; j < 12; j++)
                at.W[j][l] = T[12 * from + j];
            for (int i = 0; i < n; i++) {
                at.low[i][l] = low[n * from + i];
                at.high[i][l] = high[n * from + i];
                here[i][l] = x[n * from + i];
            }
            trust[l] = 1.0;
            over[l] = l >= count;
        }
        moved_tools(chain, here, at.W, size, &at.tools, now[0], now[1]);
        for (int made = 0; made < steps && going; made++) {
            memcpy(at.x, here, sizeof here);
            turning_step(chain, size, &at, dx);
            for (int l = 0; l < LANES; l++) {
                double longest = 0.0;
                for (int i = 0; i < n; i++) {
                    dx[i][l] *= trust[l];
                    longest = fabs(dx[i][l]) > longest ? fabs(dx[i][l]) : longest;
                    at.x[i][l] = here[i][l] + dx[i][l];
                }
                if (!over[l] && !(longest > TURN_SHORTEST)) {
                    over[l] = 1;
                    going--;
                }
            }
            if (!going)
                break;
            led_back(chain, size, &at);
            moved_tools(chain, at.x, at.W, size, &at.tools, place, turn);
            for (int l = 0; l < LANES; l++) {
                double before = sqrt(2.0 * now[0][l]);
                before = before > TURN_HAS_POSITION ? before : TURN_HAS_POSITION;
                int less = sqrt(2.0 * place[l]) <= before && turn[l] < now[1][l];
                trust[l] = less ? (2.0 * trust[l] < 1.0 ? 2.0 * trust[l] : 1.0) : 0.25 * trust[l];
                if (!less || over[l])
                    continue;
                now[0][l] = place[l];
                now[1][l] = turn[l];
                for (int i = 0; i < n; i++)
                    here[i][l] = at.x[i][l];
            }
        }
        for (int l = 0; l < count; l++) {
            for (int i = 0; i < n; i++)
                x[n * (first + l) + i] = here[i][l];
            left[2 * (first + l)] = now[0][l];
            left[2 * (first + l) + 1] = now[1][l];
        }
    }
}
