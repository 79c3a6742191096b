/* The self-motions of an arm with a spherical shoulder and wrist within its limits, for one pose at a time.

   As robokin/inverse/self_motion/swivel_curves.py, swivel_pieces.py, swivel_members.py and spread.py have it, step by
   step, where the derivations stand. Where one of those doubts, the pose is left to Python.
   Margins from limits are told by cosines where they are clear; angles are worked out where they are not.
*/

#include "swivel.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#if defined(_MSC_VER) && !defined(__clang__)
#pragma fp_contract(off)
#endif

static const double PI = 3.14159265358979323846, TURN = 6.28318530717958647692;

/* Of swivel_curves.py. */
static const double NO_LINE = 1e-3, ON_LINE = 1e-9, OFF_LINE = 1e-4, STRAIGHT = 1e-14, BENT = 5e-7, ALIGNED = 5e-7,
                    FIRM = 0.1;

/* Of swivel_pieces.py: SURE is half of LIMIT_TOLERANCE. */
static const double TOUCHES = 1e-9, ALIKE = 1e-11, VAGUE = 1e-4, VAGUEST = 1e-3, MEETS = 1e-8, SURE = 0.5e-9;

/* Of swivel_members.py, verify.py and known_motions.py. */
static const double COUNT = 67.0, APART = 1e-5, ROUNDS_UP = 0.5 + 1e-6, CLOSES = 1e-9, STILL = 1e-9;
#define LOOKS 12

/* Of spread.py: ten to the DECIMALS. WHOLE is 1.5 times 2 to the 52: a sum with it has no digits behind the point. */
static const double DECIMALS = 1e7, WHOLE = 6755399441055744.0;

/* A margin [rad] that is clear, far above VAGUEST. */
static const double CLEAR = 1e-2;

#define MOST_MEETINGS (2 * MOST_BOUNDS)

/* The first joints of the triples. */
static const int FIRST[2] = {0, 4};

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* fmin and fmax without a call; of a number that is none the other one, if it comes first. */
static double lesser(double a, double b) { return a < b ? a : b; }

static double greater(double a, double b) { return a > b ? a : b; }

static double wrapped(double angle) { return angle - TURN * rint(angle / TURN); }

/* -180 degrees are 180, whatever the last digits say. */
static double upwards(double angle) { return angle < HALF_TURN - PI ? angle + TURN : angle; }

/* A x and Aᵀ x of a matrix row by row. */
static void times(const double *A, const double *x, double *out) {
    for (int r = 0; r < 3; r++)
        out[r] = dot(A + 3 * r, x);
}

static void backwards(const double *A, const double *x, double *out) {
    for (int c = 0; c < 3; c++)
        out[c] = A[c] * x[0] + A[3 + c] * x[1] + A[6 + c] * x[2];
}

void prepared_swivel(SwivelArm *arm) {
    for (int i = 0; i < SEVEN; i++) {
        arm->cos_middle[i] = cos(arm->middle[i]);
        arm->sin_middle[i] = sin(arm->middle[i]);
        arm->within[i] = arm->half[i] > CLEAR ? cos(fmin(arm->half[i] - CLEAR, PI)) : 2.0;
        arm->beyond[i] = arm->half[i] + CLEAR < PI ? cos(arm->half[i] + CLEAR) : -2.0;
        arm->stopping |= arm->stops[i];
    }
}

/* Orthonormal columns along the line, at right angles to it towards something, across; how far that is off the line. */
static double axes_of(const double *line, const double *towards, double A[3][3]) {
    double first[3], second[3], length = fmax(sqrt(dot(line, line)), 1e-300);
    for (int r = 0; r < 3; r++)
        first[r] = line[r] / length;
    double along = dot(towards, first);
    for (int r = 0; r < 3; r++)
        second[r] = towards[r] - along * first[r];
    along = dot(second, first); /* what rounding left */
    for (int r = 0; r < 3; r++)
        second[r] -= along * first[r];
    double off = sqrt(dot(second, second));
    length = fmax(off, 1e-300);
    for (int r = 0; r < 3; r++)
        second[r] /= length;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        A[r][0] = first[r];
        A[r][1] = second[r];
        A[r][2] = first[a] * second[b] - first[b] * second[a];
    }
    return off;
}

/* The factors of 1, cos psi and sin psi in R(±psi) x, from what its axes come to and x in these. */
static void swung(double axes[3][3], const double other[3], double sign, int rows, double out[][3]) {
    for (int r = 0; r < rows; r++) {
        out[r][0] = axes[r][0] * other[0];
        out[r][1] = axes[r][1] * other[1] + axes[r][2] * other[2];
        out[r][2] = sign * (axes[r][2] * other[1] - axes[r][1] * other[2]);
    }
}

/* The curves of a target, or 0 where there is doubt. */
static int curves_of(const SwivelArm *arm, const double *T, SwivelCurves *out) {
    double R[9], hand[3][3], p[3], x[3], p_axes[3][3], along[3][3], swapped[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            R[3 * r + c] = T[4 * r + c];
    times(R, arm->wrist, x);
    for (int r = 0; r < 3; r++)
        x[r] += T[4 * r + 3] - arm->origin[r];
    backwards(arm->base, x, p);
    for (int r = 0; r < 3; r++)
        p[r] -= arm->shoulder[r];
    for (int c = 0; c < 3; c++) {
        double column[3] = {arm->hand[c], arm->hand[3 + c], arm->hand[6 + c]}, turned[3];
        times(R, column, turned);
        backwards(arm->base, turned, x);
        for (int r = 0; r < 3; r++)
            hand[r][c] = x[r];
    }
    /* The elbows. */
    const double *s = arm->seen, *w = arm->lower;
    double cosine = s[0] * w[0] + s[1] * w[1], sine = s[1] * w[0] - s[0] * w[1], square = dot(p, p);
    double wave = (0.5 * (dot(s, s) + dot(w, w) - square) - s[2] * w[2]) / hypot(cosine, sine);
    double past = fabs(wave) - 1.0, length = sqrt(square), off = hypot(p[0], p[1]);
    int straight = fabs(past) <= STRAIGHT;
    if ((!straight && fabs(past) < BENT) || (straight && length < FIRM * arm->size))
        return 0;
    double amid = atan2(sine, cosine), side = acos(fmax(-1.0, fmin(straight ? rint(wave) : wave, 1.0)));
    out->straight = straight;
    out->q4[0] = amid + side;
    out->q4[1] = amid - side;
    out->real[0] = straight || past < 0.0;
    out->real[1] = !straight && past < 0.0;
    /* The base's axes. */
    int beside = off >= ON_LINE * length;
    if (length < NO_LINE * arm->size || (beside && off < OFF_LINE * length))
        return 0;
    static const double UP[3] = {0.0, 0.0, 1.0}, AHEAD[3] = {1.0, 0.0, 0.0};
    axes_of(p, beside ? UP : AHEAD, p_axes);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            along[r][c] = p_axes[0][r] * hand[0][c] + p_axes[1][r] * hand[1][c] + p_axes[2][r] * hand[2][c];
            swapped[c][r] = along[r][c];
        }
    for (int e = 0; e < 2; e++) {
        if (!out->real[e])
            continue;
        double c4 = cos(out->q4[e]), s4 = sin(out->q4[e]), v[3], v_axes[3][3], seen[3][3];
        double bent[3] = {c4 * w[0] - s4 * w[1], s4 * w[0] + c4 * w[1], w[2]};
        times(arm->forearm, bent, v);
        for (int r = 0; r < 3; r++)
            v[r] += arm->forearm_origin[r] - arm->upper[r];
        double far = axes_of(v, arm->elbow, v_axes);
        if (far < ON_LINE * arm->size) {
            double z[3] = {arm->forearm[2], arm->forearm[5], arm->forearm[8]}, across[3];
            for (int r = 0; r < 3; r++) {
                int a = (r + 1) % 3, b = (r + 2) % 3;
                across[r] = z[a] * v[b] - z[b] * v[a];
            }
            axes_of(v, across, v_axes);
        } else if (far < OFF_LINE * arm->size) {
            return 0;
        }
        for (int c = 0; c < 3; c++) {
            /* The forearm's frame sees v, e, f: backwards through C3, Rz(q4), C4. */
            double column[3] = {v_axes[0][c], v_axes[1][c], v_axes[2][c]}, a[3];
            backwards(arm->forearm, column, a);
            double b[3] = {c4 * a[0] + s4 * a[1], c4 * a[1] - s4 * a[0], a[2]};
            backwards(arm->next, b, x);
            for (int r = 0; r < 3; r++)
                seen[r][c] = x[r];
        }
        double last[3] = {along[0][2], along[1][2], along[2][2]};
        swung(p_axes, v_axes[2], 1.0, 3, out->entries[e][0]);
        swung(v_axes, p_axes[2], -1.0, 2, out->entries[e][0] + 3);
        swung(seen, last, -1.0, 3, out->entries[e][1]);
        swung(swapped, seen[2], 1.0, 2, out->entries[e][1] + 3);
        double straightest = straight ? 1.0 - sqrt(1.0 - FIRM * FIRM) : ALIGNED;
        for (int t = 0; t < 2; t++) {
            const double *entry = out->entries[e][t][2];
            double swing = hypot(entry[1], entry[2]), middle = entry[0] - arm->k[t], r = arm->r[t];
            if (!(fmin(r - (middle + swing), r + (middle - swing)) / r >= straightest))
                return 0;
        }
    }
    return 1;
}

/* A triple at psi: its entries 13, 23, 33, 31, 32, cosine and sine of its middle turn but for the sign of this. */
typedef struct {
    double g[5], cosine, sine;
} Triple;

static void triple_at(const SwivelArm *arm, const SwivelCurves *curves, int e, int t, double c, double s, Triple *out) {
    for (int j = 0; j < 5; j++) {
        const double *entry = curves->entries[e][t][j];
        out->g[j] = entry[0] + entry[1] * c + entry[2] * s;
    }
    double x = greater(lesser((out->g[2] - arm->k[t]) / arm->r[t], 1.0), -1.0);
    out->cosine = x;
    out->sine = sqrt((1.0 - x) * (1.0 + x));
}

/* For one sign of its middle turn: sines and cosines of its turns, but for a factor. */
static void turned(const SwivelArm *arm, const Triple *triple, int t, int sign, double y[3], double x[3]) {
    const double *g = triple->g;
    double cosine = triple->cosine, sine = sign ? -triple->sine : triple->sine;
    double cb = cosine * arm->cos_phi[t] - sine * arm->sin_phi[t], sb = sine * arm->cos_phi[t] + cosine * arm->sin_phi[t];
    double u[2], v[2];
    for (int j = 0; j < 2; j++) {
        u[j] = arm->u[j][0][t] + arm->u[j][1][t] * cb + arm->u[j][2][t] * sb;
        v[j] = arm->v[j][0][t] + arm->v[j][1][t] * cb + arm->v[j][2][t] * sb;
    }
    y[0] = g[1] * u[0] - g[0] * u[1];
    x[0] = g[0] * u[0] + g[1] * u[1];
    y[1] = sb;
    x[1] = cb;
    y[2] = v[1] * g[3] - v[0] * g[4];
    x[2] = v[0] * g[3] + v[1] * g[4];
}

/* The least margin from the limits of a triple's joints; one that is clear is told as CLEAR or -CLEAR. */
static double margin_of(const SwivelArm *arm, const Triple *triple, int t, int sign, int *meets) {
    double y[3], x[3], least = CLEAR;
    turned(arm, triple, t, sign, y, x);
    for (int j = 0; j < 3; j++) {
        int i = FIRST[t] + j;
        int free = arm->half[i] > TURN;
        if (free && !(meets && arm->stops[i]))
            continue;
        double ahead = x[j] * arm->cos_middle[i] + y[j] * arm->sin_middle[i], length = sqrt(x[j] * x[j] + y[j] * y[j]);
        if (free) {
            /* Limits a full turn apart: are these met? */
            if (ahead > (5e-5 - 1.0) * length)
                continue;
            *meets |= fabs(wrapped(atan2(y[j], x[j]) - arm->middle[i])) >= PI - MEETS;
            continue;
        }
        if (ahead > arm->within[i] * length)
            continue;
        if (ahead < arm->beyond[i] * length) {
            least = -CLEAR;
            if (!meets)
                return least;
            continue;
        }
        double left = arm->half[i] - fabs(wrapped(atan2(y[j], x[j]) - arm->middle[i]));
        least = left < least ? left : least;
    }
    return least;
}

/* The values of psi (at most MOST_MEETINGS, in order) at which a joint may be at a limit; -1 where one touches it. */
static int meetings(const SwivelArm *arm, const SwivelCurves *curves, int e, double vague, double *psi) {
    int count = 0;
    const double(*entry)[3] = curves->entries[e][0];
    for (int b = 0; b < arm->bounds; b++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (int j = 0; j < 10; j++)
            if (arm->matrix[b][j] != 0.0)
                for (int f = 0; f < 3; f++)
                    sum[f] += arm->matrix[b][j] * entry[j][f];
        double swing = hypot(sum[1], sum[2]), off = arm->value[b] - sum[0];
        if (!(fabs(fabs(off) - swing) >= vague))
            return -1;
        double x = off / swing;
        if (!(fabs(x) <= 1.0 + TOUCHES)) {
            psi[count++] = -PI;
            psi[count++] = -PI;
            continue;
        }
        double side = acos(fmax(-1.0, fmin(x, 1.0))), amid = atan2(sum[2], sum[1]);
        psi[count++] = wrapped(amid - side);
        psi[count++] = wrapped(amid + side);
    }
    if (!count)
        psi[count++] = -PI;
    for (int i = 1; i < count; i++) {
        double value = psi[i];
        int j = i;
        for (; j && psi[j - 1] > value; j--)
            psi[j] = psi[j - 1];
        psi[j] = value;
    }
    return count;
}

/* The places of one elbow that have an inside, and what is known there by the signs of shoulder and wrist. */
typedef struct {
    int count;
    double psi[MOST_MEETINGS], at[MOST_MEETINGS][4], amid[MOST_MEETINGS][4];
    unsigned char stopped[MOST_MEETINGS][4];
} Places;

static void looked_at(const SwivelArm *arm, const SwivelCurves *curves, int e, double psi, double out[4],
                      unsigned char *stopped) {
    double margin[2][2], c = cos(psi), s = sin(psi);
    int meets[2][2] = {{0, 0}, {0, 0}}, stopping = stopped && arm->stopping;
    for (int t = 0; t < 2; t++) {
        Triple triple;
        /* What the shoulder is clearly beyond its limits for needs no wrist. */
        if (t && !stopping && greater(margin[0][0], margin[0][1]) == -CLEAR) {
            margin[1][0] = margin[1][1] = CLEAR;
            break;
        }
        triple_at(arm, curves, e, t, c, s, &triple);
        for (int sign = 0; sign < 2; sign++)
            margin[t][sign] = margin_of(arm, &triple, t, sign, stopping ? &meets[t][sign] : NULL);
    }
    for (int pair = 0; pair < 4; pair++) {
        out[pair] = lesser(margin[0][pair >> 1], margin[1][pair & 1]);
        if (stopped)
            stopped[pair] = (unsigned char)(meets[0][pair >> 1] | meets[1][pair & 1]);
    }
}

static int places_of(const SwivelArm *arm, const SwivelCurves *curves, int e, double vague, Places *out) {
    double psi[MOST_MEETINGS];
    int count = meetings(arm, curves, e, vague, psi), kept = 0;
    if (count < 0)
        return 0;
    for (int k = 0; k < count; k++) {
        double gap = (k + 1 < count ? psi[k + 1] : psi[0] + TURN) - psi[k];
        if (gap < ALIKE)
            continue;
        out->psi[kept] = psi[k];
        looked_at(arm, curves, e, psi[k], out->at[kept], out->stopped[kept]);
        looked_at(arm, curves, e, psi[k] + 0.5 * gap, out->amid[kept], NULL);
        kept++;
    }
    out->count = kept;
    return 1;
}

static int added(SwivelAnswer *out, int code, double first, double last, int whole) {
    if (out->pieces == MOST_PIECES)
        return 0;
    SwivelPiece *piece = out->piece + out->pieces++;
    piece->code = code;
    piece->first = first;
    piece->last = last;
    piece->whole = whole;
    return 1;
}

/* The pieces of one curve, or 0 where there is doubt. */
static int pieces_of(const Places *places, int code, double vague, int straight, SwivelAnswer *out) {
    int n = places->count, pair = code & 3, all = 1, start = out->pieces;
    unsigned char within[MOST_MEETINGS], begins[MOST_MEETINGS], ends[MOST_MEETINGS];
    for (int k = 0; k < n; k++) {
        within[k] = places->amid[k][pair] >= -SURE;
        if (!within[k] && places->amid[k][pair] > -vague)
            return 0;
        all &= within[k];
    }
    for (int k = 0; k < n; k++) {
        int before = within[k ? k - 1 : n - 1];
        double at = places->at[k][pair];
        int stop = places->stopped[k][pair] && within[k] && before;
        begins[k] = (within[k] && !before) || stop;
        ends[k] = (before && !within[k]) || stop;
        all &= !stop;
        if (within[k] != before || at < -vague)
            continue;
        /* On a limit is within it, also in a single point; a little beyond may be rounding. */
        if (at < -SURE)
            return 0;
        if (!within[k] && !added(out, code, places->psi[k], places->psi[k], 0))
            return 0;
    }
    for (int k = 0; k < n; k++) {
        if (!begins[k])
            continue;
        int end = k;
        do
            end = end + 1 < n ? end + 1 : 0;
        while (!ends[end] && end != k);
        double first = places->psi[k], last = places->psi[end];
        if (!added(out, code, first, last <= first ? last + TURN : last, 0))
            return 0;
    }
    if (all && !added(out, code, -PI, PI, 1))
        return 0;
    for (int i = start + 1; i < out->pieces; i++) {
        SwivelPiece piece = out->piece[i];
        int j = i;
        for (; j > start && out->piece[j - 1].first > piece.first; j--)
            out->piece[j] = out->piece[j - 1];
        out->piece[j] = piece;
    }
    for (int i = start; i < out->pieces; i++) {
        const SwivelPiece *piece = out->piece + i;
        double length = piece->last - piece->first, left = TURN - length;
        if (length < vague && (length > 0.0 || straight))
            return 0;
        if (!piece->whole && left < vague && left > ALIKE)
            return 0;
        double gap = i > start ? piece->first - piece[-1].last : 0.0;
        if (gap < vague && gap != 0.0)
            return 0;
    }
    return 1;
}

/* The configuration of a curve at psi, angles in [-pi, pi]. */
static void configuration(const SwivelArm *arm, const SwivelCurves *curves, int code, double psi, double *q) {
    double y[3], x[3], c = cos(psi), s = sin(psi);
    int e = code >> 2;
    for (int t = 0; t < 2; t++) {
        Triple triple;
        triple_at(arm, curves, e, t, c, s, &triple);
        turned(arm, &triple, t, t ? code & 1 : (code >> 1) & 1, y, x);
        for (int j = 0; j < 3; j++)
            q[FIRST[t] + j] = upwards(wrapped(atan2(y[j], x[j]) - arm->chain.offsets[FIRST[t] + j]));
    }
    q[3] = upwards(wrapped(curves->q4[e] - arm->chain.offsets[3]));
}

/* Configurations at equal distances on the pieces; how many, 0 for too many. */
static int placed(const SwivelArm *arm, const SwivelCurves *curves, const SwivelAnswer *answer, double (*q)[SEVEN],
                  int *code) {
    double total = 0.0;
    int count = 0;
    for (int i = 0; i < answer->pieces; i++)
        total += answer->piece[i].last - answer->piece[i].first;
    for (int i = 0; i < answer->pieces; i++) {
        const SwivelPiece *piece = answer->piece + i;
        double length = piece->last - piece->first;
        int many = (int)fmin(fmax(floor(COUNT * length / fmax(total, APART) + ROUNDS_UP), 1.0), fmax(length / APART, 1.0));
        if (count + many > MOST_PLACED)
            return 0;
        for (int k = 0; k < many; k++, count++) {
            configuration(arm, curves, piece->code, piece->first + (k + 0.5) * (length / many), q[count]);
            code[count] = piece->code;
        }
    }
    return count;
}

/* Whether a configuration is within the limits, its angles turned into them. */
static int into_limits(const SwivelArm *arm, double *q) {
    int inside = 1;
    for (int i = 0; i < SEVEN; i++) {
        double low = arm->low[i], high = arm->high[i];
        int fits = q[i] >= low && q[i] <= high;
        if (!fits && (low < -PI || high > PI)) {
            double least = ceil((low - q[i]) / TURN), most = floor((high - q[i]) / TURN);
            if (least <= most) {
                q[i] += TURN * fmin(fmax(0.0, least), most);
                fits = q[i] >= low && q[i] <= high;
            }
        }
        inside &= fits;
    }
    return inside;
}

/* Distances count in whole parts of 1 / DECIMALS, rounded to even. */
static int parts_of(double distance) { return (int)(distance * DECIMALS + WHOLE - WHOLE); }

/* The places of up to `most` well spread ones of some configurations, each joint in a row of its own. */
static int spread(double (*x)[MOST_PLACED], int count, const double *rest, double (*q)[SEVEN], int most, int *chosen) {
    double gap[MOST_PLACED], least = INFINITY;
    int distance[MOST_PLACED], pick = 0, found = 0;
    for (int k = 0; k < count; k++) {
        double move = 0.0;
        for (int i = 0; i < SEVEN; i++)
            move = greater(move, fabs(q[k][i] - rest[i]));
        move = rint(move * DECIMALS);
        if (move < least) {
            least = move;
            pick = k;
        }
        distance[k] = INT_MAX;
    }
    for (;;) {
        chosen[found++] = pick;
        if (found == most || found == count)
            return found;
        for (int k = 0; k < count; k++)
            gap[k] = 0.0;
        for (int i = 0; i < SEVEN; i++) {
            const double *row = x[i];
            double from = row[pick];
            for (int k = 0; k < count; k++) {
                double away = fabs(row[k] - from), back = TURN - away;
                gap[k] = greater(gap[k], lesser(away, back));
            }
        }
        distance[pick] = -1;
        int best = -1;
        for (int k = 0; k < count; k++) {
            int rounded = parts_of(gap[k]);
            distance[k] = distance[k] < rounded ? distance[k] : rounded;
            best = best > distance[k] ? best : distance[k];
        }
        for (pick = 0; distance[pick] != best; pick++)
            ;
    }
}

int swivel_answer(const SwivelArm *arm, void (*poses)(const Chain *, const double *, ptrdiff_t, double *),
                  const double *T, int most, SwivelCurves *curves, SwivelAnswer *out) {
    double q[MOST_PLACED][SEVEN], reached[MOST_PLACED][16], x[SEVEN][MOST_PLACED];
    double position[MOST_PLACED], angle[MOST_PLACED];
    int code[MOST_PLACED], chosen[MOST_LISTED];
    if (!curves_of(arm, T, curves))
        return 0;
    double vague = curves->straight ? VAGUEST : VAGUE;
    out->pieces = 0;
    for (int e = 0; e < 2; e++) {
        Places places;
        if (!curves->real[e])
            continue;
        double room = arm->half[3] - fabs(wrapped(curves->q4[e] - arm->middle[3]));
        if (room < -SURE && room > -vague)
            return 0;
        if (room < -SURE)
            continue;
        if (!places_of(arm, curves, e, vague, &places))
            return 0;
        for (int pair = 0; pair < 4; pair++)
            if (!pieces_of(&places, 4 * e + pair, vague, curves->straight, out))
                return 0;
    }
    int count = placed(arm, curves, out, q, code), closing = 0, within = 0;
    if (!count)
        return 0;
    poses(&arm->chain, q[0], count, reached[0]);
    for (int k = 0; k < count; k++) {
        double off = 0.0, chord = 0.0;
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++) {
                double away = T[4 * r + c] - reached[k][4 * r + c];
                *(c < 3 ? &chord : &off) += away * away;
            }
        off = sqrt(off);
        double turn = 2.0 * asin(fmin(sqrt(chord) / sqrt(8.0), 1.0));
        if (!(off <= CLOSES * arm->size && turn <= CLOSES))
            continue;
        closing++;
        double own[SEVEN];
        memcpy(own, q[k], sizeof own);
        if (!into_limits(arm, own))
            continue;
        for (int i = 0; i < SEVEN; i++)
            x[i][within] = wrapped(own[i]);
        memcpy(q[within], own, sizeof own);
        position[within] = off;
        angle[within] = turn;
        code[within] = code[k];
        within++;
    }
    if (!within)
        return 0;
    out->closing = closing;
    out->within = within;
    out->listed = spread(x, within, arm->rest, q, most, chosen);
    for (int k = 0; k < out->listed; k++) {
        memcpy(out->q[k], q[chosen[k]], sizeof out->q[k]);
        out->position[k] = position[chosen[k]];
        out->angle[k] = angle[chosen[k]];
        out->code[k] = code[chosen[k]];
    }
    return 1;
}

int swivel_moving(const SwivelArm *arm, const SwivelCurves *curves, int code) {
    double first[SEVEN], q[SEVEN];
    int moving = 0;
    for (int look = 0; look < LOOKS; look++) {
        configuration(arm, curves, code, look * (TURN / LOOKS) - PI, look ? q : first);
        for (int i = 0; look && i < SEVEN; i++)
            moving |= (fabs(wrapped(q[i] - first[i])) > STILL) << i;
        if (moving == 127 - 8)
            break;
    }
    return moving;
}
