/* Paths of complex solutions of a loop, followed from targets where all are known to others, four at once.

   Python's `homotopy_paths` is the reference, and says what is derived how. A path that has come to its end makes room
   for the next one; where it ends does not depend on the others. Comes after complex_loop.h.
*/

/* See `homotopy_paths` for these. */
#define FIRST_STEP 0.015
#define OFF 5e-2
#define AIM 1e-2
#define CONTRACTS 0.1
#define BESIDE_END 0.05
#define NOISE 1e-7
#define EXACT 1e-12
#define STRIDE 0.7
#define END_S 3.1622776601683795e-06
#define NEAR_U 1e-6
#define NEAR_S 1e-3
#define SHORTEST 5e-8
#define LAST_STEP 0.8
#define AGAIN 0.5
#define MOST_PATH_STEPS 400
#define LATE_MOST 120
#define FAR_AWAY 16.0

/* Four paths: a target is a quaternion and a translation. */
typedef struct {
    Complex q[6], v[6], before[6], tangent[6]; /* points and dq/ds, here and one step before */
    Complex from[7], to[7], bend;
    Part s, h, gone, tried;
    int late[4], made[4];
    ptrdiff_t path[4]; /* -1 where there is none */
} Four;

/* The columns of L6 at u on the way, and the twist by which joints must move as u falls. */
static void on_line(const Four *F, Part u, Complex L[4][3], Complex twist[6]) {
    const Complex one = {ONE, {0.0}};
    Complex rate[4], r[4], twice[4], slide[3], dot = {{0.0}, {0.0}};
    Complex below = inverse(plus(one, scaled(minus(F->bend, one), u))), w = multiplied(scaled(F->bend, u), below);
    for (int j = 0; j < 4; j++) {
        rate[j] = minus(F->to[j], F->from[j]);
        r[j] = minus(F->to[j], multiplied(w, rate[j]));
        dot = plus(dot, multiplied(r[j], r[j]));
    }
    Complex n = scaled(inverse(dot), 2.0 * ONE);
    for (int j = 0; j < 4; j++)
        twice[j] = multiplied(n, r[j]);
    for (int j = 0; j < 3; j++) {
        int k = (j + 1) % 3, l = (j + 2) % 3;
        L[j][j] = minus(one, plus(multiplied(twice[1 + k], r[1 + k]), multiplied(twice[1 + l], r[1 + l])));
        L[j][k] = plus(multiplied(twice[1 + j], r[1 + k]), multiplied(twice[0], r[1 + l]));
        L[k][j] = minus(multiplied(twice[1 + j], r[1 + k]), multiplied(twice[0], r[1 + l]));
        slide[j] = minus(F->to[4 + j], F->from[4 + j]);
        L[3][j] = minus(F->to[4 + j], multiplied(w, slide[j]));
    }
    Complex speed = multiplied(F->bend, multiplied(below, below));
    speed = (Complex){-speed.re, -speed.im};
    for (int j = 0; j < 3; j++) {
        int k = (j + 1) % 3, l = (j + 2) % 3;
        Complex along = plus(multiplied(L[j][0], slide[0]), plus(multiplied(L[j][1], slide[1]), multiplied(L[j][2], slide[2])));
        Complex turn = minus(multiplied(twice[0], rate[1 + j]), multiplied(twice[1 + j], rate[0]));
        turn = plus(turn, minus(multiplied(twice[1 + l], rate[1 + k]), multiplied(twice[1 + k], rate[1 + l])));
        twist[j] = multiplied(along, speed);
        twist[3 + j] = multiplied(turn, speed);
    }
}

/* What lengths of a joint's motion count by: long slides relative to their length. */
static Part weight(const Chain *loop, int i, Complex q) {
    if (loop->revolute[i])
        return ONE;
    return 1.0 / (1.0 + roots(absolute_squared(q)));
}

/* The greatest |x_i| by these weights. */
static Part longest_of(const Complex x[6], const Part weights[6]) {
    Part out = {0.0};
    for (int i = 0; i < 6; i++) {
        Part size = roots(absolute_squared(x[i])) * weights[i];
        /* What is no number stays one. */
        out = chosen((size > out) | (size != size), size, out);
    }
    return out;
}

/* How far towards infinity values are. */
static double distance_of(const Chain *loop, const Complex q[6], int l) {
    double out = 0.0;
    for (int i = 0; i < 6; i++) {
        double x = q[i].re[l], y = q[i].im[l];
        double size = loop->revolute[i] ? fabs(y) : log1p(sqrt(x * x + y * y));
        out = size > out ? size : out;
    }
    return out;
}

/* Path `from`, whose solution stands in `values`, in the place of one of the four. */
static void put_path(Four *F, int l, const double *start, const double *target, const double *bend,
                     const double *values) {
    for (int j = 0; j < 7; j++) {
        F->from[j].re[l] = start[2 * j];
        F->from[j].im[l] = start[2 * j + 1];
        F->to[j].re[l] = target[2 * j];
        F->to[j].im[l] = target[2 * j + 1];
    }
    F->bend.re[l] = bend[0];
    F->bend.im[l] = bend[1];
    for (int i = 0; i < 6; i++) {
        F->q[i].re[l] = values[2 * i];
        F->q[i].im[l] = values[2 * i + 1];
    }
    F->s[l] = 1.0;
    F->h[l] = FIRST_STEP;
    F->gone[l] = F->tried[l] = HUGE_VAL;
    F->late[l] = F->made[l] = 0;
}

/* The tangents of the paths that are new; nothing but these is known of them. */
static void set_out(const Chain *loop, Four *F, const int fresh[4]) {
    Complex L[4][3], S[6][6], X[4][3], b[1][6];
    Part size;
    on_line(F, F->s * F->s, L, b[0]);
    complex_followed(loop, F->q, S, X, &size);
    complex_solved(S, b, 1);
    for (int l = 0; l < 4; l++)
        for (int i = 0; fresh[l] && i < 6; i++) {
            F->v[i].re[l] = 2.0 * b[0][i].re[l];
            F->v[i].im[l] = 2.0 * b[0][i].im[l];
            F->before[i].re[l] = F->q[i].re[l];
            F->before[i].im[l] = F->q[i].im[l];
            F->tangent[i].re[l] = F->v[i].re[l];
            F->tangent[i].im[l] = F->v[i].im[l];
        }
}

/* A step of each path, taken or not; `over`: which ones have come to their end, `stuck`: which do not get on. */
static void path_step(const Chain *loop, Four *F, int over[4], int stuck[4]) {
    Complex guess[6], way[6], L[4][3], S[6][6], X[4][3], b[2][6], lack;
    Part size, to, weights[6];
    int ending[4];
    for (int l = 0; l < 4; l++) {
        double s = F->s[l], h = F->h[l], room = s - 0.999 * END_S;
        ending[l] = h > LAST_STEP * s && s < AGAIN * F->tried[l];
        h = h < LAST_STEP * s ? h : LAST_STEP * s;
        room = room > 0.0 ? room : 0.0;
        F->h[l] = ending[l] ? s : h < room ? h : room;
    }
    to = F->s - F->h;
    Part slow = F->h * F->h / F->gone, ratio = 1.0 + F->h / F->gone;
    for (int i = 0; i < 6; i++) {
        Complex D = minus(F->q[i], F->before[i]), v = F->v[i];
        D = (Complex){D.re / F->gone, D.im / F->gone};
        Complex third = minus(plus(v, F->tangent[i]), scaled(D, 2.0 * ONE));
        Complex bend = plus(minus(v, D), scaled(third, ratio));
        guess[i] = plus(plus(F->q[i], scaled(v, F->h)), scaled(bend, slow));
        weights[i] = weight(loop, i, F->q[i]);
        way[i] = minus(guess[i], F->q[i]);
    }
    Part stride = longest_of(way, weights);
    on_line(F, to * to, L, b[1]);
    complex_followed(loop, guess, S, X, &size);
    complex_closed(X, L);
    complex_error(X, b[0], &lack);
    complex_solved(S, b, 1);
    for (int i = 0; i < 6; i++)
        guess[i] = minus(guess[i], b[0][i]);
    Part one = longest_of(b[0], weights);
    complex_followed(loop, guess, S, X, &size);
    complex_closed(X, L);
    complex_error(X, b[0], &lack);
    complex_solved(S, b, 2);
    Part two = longest_of(b[0], weights);
    for (int l = 0; l < 4; l++) {
        double s = F->s[l], h = F->h[l], first = one[l], second = two[l], length = stride[l];
        double small = CONTRACTS * first, beside = to[l] > 0.0 ? BESIDE_END * to[l] : HUGE_VAL;
        double least = to[l] > 0.0 ? NOISE : EXACT;
        small = small < beside ? small : beside;
        int fine = first < OFF && second < (small > least ? small : least) && length < STRIDE && !(s <= END_S);
        double aim = sqrt(sqrt(AIM / first)), factor = STRIDE / length;
        factor = 0.9 * (aim < factor ? aim : factor);
        if (!(first == first) || !(length == length) || !(first < HUGE_VAL && length < HUGE_VAL))
            factor = 0.1;
        double lowest = fine ? 0.4 : 0.1, highest = fine ? 2.5 : 0.4;
        factor = factor < lowest ? lowest : factor > highest ? highest : factor;
        if (ending[l] && !fine) {
            factor = LAST_STEP;
            F->tried[l] = s;
        }
        if (fine) {
            for (int i = 0; i < 6; i++) {
                F->before[i].re[l] = F->q[i].re[l];
                F->before[i].im[l] = F->q[i].im[l];
                F->tangent[i].re[l] = F->v[i].re[l];
                F->tangent[i].im[l] = F->v[i].im[l];
                F->q[i].re[l] = guess[i].re[l] - b[0][i].re[l];
                F->q[i].im[l] = guess[i].im[l] - b[0][i].im[l];
                F->v[i].re[l] = 2.0 * to[l] * b[1][i].re[l];
                F->v[i].im[l] = 2.0 * to[l] * b[1][i].im[l];
            }
            F->s[l] = s = to[l];
            F->gone[l] = h;
        }
        F->h[l] = h = h * factor;
        F->made[l]++;
        stuck[l] = !fine && h < SHORTEST * s;
        F->late[l] += s < NEAR_S;
        over[l] = s <= END_S || stuck[l] || F->late[l] > LATE_MOST || distance_of(loop, F->q, l) > FAR_AWAY;
        if (!over[l] && F->made[l] >= MOST_PATH_STEPS)
            over[l] = stuck[l] = 1;
    }
}

/* Paths (m,) from `start` to `target` (m, 7) with their bends (m,), followed from `values` (m, 6), all complex numbers.

   What they lead to stands in `values`; in `left` (m, 3) u, the speed there, and whether they were lost. */
void NAMED(tracked)(const Chain *loop, const double *start, const double *target, const double *bend, ptrdiff_t m,
                    double *values, double *left) {
    Four F;
    ptrdiff_t next = 0, going = 0;
    int fresh[4] = {1, 1, 1, 1}, over[4], stuck[4];
    if (!m)
        return;
    memset(&F, 0, sizeof F);
    for (int l = 0; l < 4; l++) {
        ptrdiff_t row = next < m ? next : 0;
        put_path(&F, l, start + 14 * row, target + 14 * row, bend + 2 * row, values + 12 * row);
        F.path[l] = next < m ? next++ : -1;
        going += F.path[l] >= 0;
    }
    set_out(loop, &F, fresh);
    while (going) {
        int more = 0;
        path_step(loop, &F, over, stuck);
        for (int l = 0; l < 4; l++) {
            ptrdiff_t row = F.path[l];
            fresh[l] = 0;
            if (row < 0 || !over[l])
                continue;
            double u = F.s[l] * F.s[l], speed = 0.0;
            for (int i = 0; i < 6; i++) {
                double x = F.v[i].re[l], y = F.v[i].im[l], size = sqrt(x * x + y * y);
                size *= weight(loop, i, F.q[i])[l];
                speed = size > speed ? size : speed;
                values[12 * row + 2 * i] = F.q[i].re[l];
                values[12 * row + 2 * i + 1] = F.q[i].im[l];
            }
            left[3 * row] = u;
            left[3 * row + 1] = 0.5 * F.s[l] * speed;
            left[3 * row + 2] = stuck[l] && u > NEAR_U;
            F.path[l] = next < m ? next : -1;
            going -= next >= m;
            if (next >= m)
                continue;
            put_path(&F, l, start + 14 * next, target + 14 * next, bend + 2 * next, values + 12 * next);
            next++;
            more = fresh[l] = 1;
        }
        if (more)
            set_out(loop, &F, fresh);
    }
}
