/* What the files of the module share: numpy's API, the arguments of calls, the set of instructions in use.

   module.c takes the methods of the others: each file has a table of its own (`more_methods`). arguments.c reads what
   they are called with.
*/

#ifndef ROBOKIN_MODULE_H
#define ROBOKIN_MODULE_H

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030a0000
#define NPY_NO_DEPRECATED_API NPY_1_19_API_VERSION
#define NPY_TARGET_VERSION NPY_1_19_API_VERSION

/* numpy's table of functions is imported by module.c alone. */
#define PY_ARRAY_UNIQUE_SYMBOL robokin_numpy
#ifndef ROBOKIN_MODULE
#define NO_IMPORT_ARRAY
#endif

#include <Python.h>
#include <numpy/arrayobject.h>

#include "elimination.h"
#include "tape.h"

/* What is compiled once for each set of instructions. */
typedef struct {
    void (*poses)(const Chain *, const double *, ptrdiff_t, double *);
    void (*frames)(const Chain *, const double *, ptrdiff_t, double *);
    void (*jacobians)(const Chain *, const double *, ptrdiff_t, double, int, double *);
    void (*errors)(const Chain *, const double *, const double *, ptrdiff_t, double, double *, double *);
    void (*descended)(const Chain *, const double *, const double *, double *, ptrdiff_t, double, const double *,
                      const double *, int, double *);
    void (*corrected)(const Chain *, const double *, const double *, int, const double *, double *, ptrdiff_t, double,
                      double, double, double *, double *);
    void (*gone_down)(const Chain *, const double *, double *, ptrdiff_t, double, const double *, const double *,
                      int, const double *, int, double, double, double *);
    void (*turned)(const Chain *, const double *, double *, ptrdiff_t, double, const double *, const double *, int,
                   double *);
    int (*advanced)(const Chain *, Fronts *);
    void (*least_values)(const double *, ptrdiff_t, int, double *);
    void (*refined)(const Chain *, const double *, double *, ptrdiff_t, int, double *);
    void (*complex_refined)(const Chain *, const double *, double *, ptrdiff_t, int, double, double *);
    void (*tracked)(const Chain *, const double *, const double *, const double *, ptrdiff_t, double *, double *);
    void (*regulars)(const Chain *, const double *, const double *, ptrdiff_t, double *);
    void (*shortest_of)(const double *, const double *, ptrdiff_t, int, int, double, double *);
    void (*finely_closed)(const Chain *, const double *, double *, ptrdiff_t, double, int, double, double, double,
                          double *);
    ptrdiff_t (*followed_rows)(const Chain *, const double *, ptrdiff_t, double, int, const double *, const double *,
                               double *, int, int, double *);
    int (*solution)(const Form *, const double *, const Wanted *, Solutions *);
    void (*solutions)(const Form *, const double *, ptrdiff_t, const Wanted *, Solutions *, ptrdiff_t *, ptrdiff_t *,
                      unsigned char *);
    void (*sides)(const Form *, const double *, ptrdiff_t, ptrdiff_t *);
    void (*prepared_elimination)(Elimination *);
    void (*eliminated)(const Elimination *, const double *, Eliminated *);
    void (*tried_candidates)(const Elimination *, const double *, int *, double *, double *);
    int (*listed_elimination)(const Elimination *, const Form *, const double *, const Wanted *, Solutions *, int *);
} Lanes;

/* Methods of the other files. */
extern PyMethodDef closed_form_methods[], curve_methods[], descent_methods[], elimination_methods[], number_text_methods[],
    solution_object_methods[], swivel_methods[], told_apart_methods[];

/* The set in use. */
extern Lanes lanes;

/* A call on fewer configurations keeps the interpreter's lock: giving it back takes longer than the work. */
#define LONG 256

/* A C-contiguous array of doubles (borrowed, or a new copy in *copy) with at least `least` dimensions. */
PyArrayObject *doubles(PyObject *object, int least, PyObject **copy);

/* An array of m rows of `width` numbers each, or of any number of rows where m is negative, which is found out. */
const double *table(PyObject *object, npy_intp width, npy_intp *m, PyObject **copy);

/* A table among the arguments of a call: where it stands, as wide as `table` wants it and with as many rows. */
typedef struct {
    int place;
    npy_intp width, *rows;
} Given;

/* The numbers of some tables in turn, each with its copy or NULL; 0 and an error where one does not fit. */
int all_tables(PyObject *const *args, const Given *given, int count, const double **from, PyObject **copies);

/* The numbers of m targets (m, 4, 4). */
const double *targets(PyObject *object, npy_intp *m, PyObject **copy);

/* Give references back, of which some may be NULL. */
void let_go(PyObject **objects, int count);

/* The chain and the joint values (..., n) of a call. */
const Chain *asked(PyObject *capsule, PyObject *object, PyArrayObject **q, PyObject **copy);

/* A new array of q's leading shape and `more` dimensions. */
PyObject *empty(PyArrayObject *q, int more, const npy_intp *shape);

/* The number of rows of q. */
npy_intp rows(PyArrayObject *q);

/* A new array (m, width), or (m,) where the width is 0. */
PyObject *new_numbers(npy_intp m, npy_intp width);

/* The numbers of an array of doubles. */
double *numbers_of(PyObject *array);

/* The tables of a batch's answers: whether a target is answered (m); of each how many candidates there were, how many
   solutions close, how many of those count for the limits, and how many are listed (m); of the listed ones, in so many
   rows a target, joint values (m, rows, joints), distances, angles and which are within the limits (m, rows). Rows
   beyond are no numbers. */
enum { PLAIN, TRIED, CLOSING, WITHIN, LISTED, VALUES, POSITION, ANGLES, INSIDE, TABLES };

/* Tables for m targets as a call gives them, or new ones for NULL; 0 and an error where they do not fit. made: (TABLES)
   references, some perhaps NULL, which the caller gives back; at: (TABLES) the first entry of each. */
int batch_tables(PyObject *given, npy_intp m, npy_intp rows, int joints, PyObject **made, void **at);

/* The name of a chain's capsule. */
#define CHAIN "robokin.chain"

#endif
