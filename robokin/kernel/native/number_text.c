/* Rows of numbers from text and as text.

   Only what is plain is read here: the reader in Python is asked about anything else, and knows what to say of it.
*/

#include "module.h"

#include "decimal.h"

#include <stdlib.h>
#include <string.h>

/* What a column of a table is. */
enum { IGNORED, NUMBER, TEXT, SOLUTION, KINDS };

/* What is found where a number is looked for. */
enum { NONE, FOUND, LONG_NUMBER };

/* Bytes of a text on which the interpreter's lock is given back. */
enum { MANY = 1 << 12 };

typedef struct {
    const char *begin, *at, *end;
    char separator;         /* ' ' for any spaces and tabs */
    const char *kinds;
    Py_ssize_t width;
    double *numbers;        /* rows of them, as many as there are lines */
    Py_ssize_t *texts;      /* begin and length of each cell that goes through */
    int points;             /* whether a number has a decimal point */
} Table;

/* A number of more digits than fit a word: Python's way. */
static int long_number(const char *from, const char *to, double *value) {
    char kept[800], *end = NULL;
    size_t length = (size_t)(to - from);
    if (length >= sizeof kept)
        return 0;
    memcpy(kept, from, length);
    kept[length] = 0;
    PyGILState_STATE held = PyGILState_Ensure();
    *value = PyOS_string_to_double(kept, &end, NULL);
    int right = !PyErr_Occurred() && end == kept + length;
    PyErr_Clear();
    PyGILState_Release(held);
    return right;
}

static int is_digit(char sign) { return (unsigned char)(sign - '0') < 10; }

/* Whether eight digits begin here, and their value; where words are stored the other way around there are none. */
static int eight_digits(const char *at, uint64_t *value) {
#if defined(_MSC_VER) || (defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
    /* Source: D. Lemire, as in decimal.c: pairs, fours and the whole by a product each. */
    const uint64_t high = 0xf0f0f0f0f0f0f0f0, mask = 0x000000ff000000ff;
    uint64_t word;
    memcpy(&word, at, sizeof word);
    if (((word & high) | ((word + 0x0606060606060606) & high) >> 4) != 0x3333333333333333)
        return 0;
    word -= 0x3030303030303030;
    word = 10 * word + (word >> 8);
    *value = ((word & mask) * 0x000f424000000064 + (word >> 16 & mask) * 0x0000271000000001) >> 32;
    return 1;
#else
    (void)at;
    (void)value;
    return 0;
#endif
}

/* The number that begins here, as float() reads it; the text ends with a sign that no number has. */
static int number(Table *table, double *value) {
    const char *from = table->at, *at = from;
    int negative = *at == '-';
    if (negative || *at == '+')
        at++;
    const char *first = at;
    uint64_t w = 0;
    for (; is_digit(*at); at++)
        w = 10 * w + (uint64_t)(*at - '0');
    Py_ssize_t count = at - first, behind = 0;
    if (*at == '.') {
        const char *point = at++;
        for (uint64_t more; table->end - at >= 8 && eight_digits(at, &more); at += 8)
            w = 100000000 * w + more;
        for (; is_digit(*at); at++)
            w = 10 * w + (uint64_t)(*at - '0');
        behind = at - point - 1;
        count += behind;
        table->points = 1;
    }
    if (!count)
        return NONE;
    int64_t exponent = 0;
    if (*at == 'e' || *at == 'E') {
        int down = *++at == '-';
        if (down || *at == '+')
            at++;
        if (!is_digit(*at))
            return NONE;
        for (; is_digit(*at); at++)
            if (exponent < 1000000000)
                exponent = 10 * exponent + (*at - '0');
        if (down)
            exponent = -exponent;
    }
    table->at = at;
    if (count > 19) {
        for (const char *sign = first; *sign == '0' || *sign == '.'; sign++)
            count -= *sign == '0';
        if (count > 19)
            return long_number(from, at, value) ? FOUND : NONE;
    }
    *value = decimal_nearest(w, exponent - behind);
    if (negative)
        *value = -*value;
    return FOUND;
}

static int is_space(const Table *table, char sign) { return sign == ' ' || (sign == '\t' && table->separator != '\t'); }

/* A cell that is no number: without its spaces; 0 where it has signs that the reader in Python should see. */
static int text(Table *table, char kind, Py_ssize_t **texts) {
    const char *from = table->at, *at = from;
    for (; (unsigned char)*at > ' ' || is_space(table, *at); at++) {
        if (*at == table->separator || (table->separator == ' ' && is_space(table, *at)))
            break;
        if (*at == '"' || *at == '#' || (unsigned char)*at >= 127 || (table->separator == ' ' && *at == ','))
            return 0;
    }
    if (table->separator == ' ' && at == from)
        return 0;
    const char *end = at;
    table->at = at;
    while (end > from && is_space(table, end[-1]))
        end--;
    if (kind == SOLUTION && end - from == 1 && *from == '0')
        return 0;
    if (kind == TEXT) {
        *(*texts)++ = from - table->begin;
        *(*texts)++ = end - from;
    }
    return 1;
}

/* Read all rows; 0 where they are not plain. */
static int read_rows(Table *table) {
    double *to = table->numbers;
    Py_ssize_t *texts = table->texts;
    while (table->at < table->end) {
        for (Py_ssize_t i = 0; i < table->width; i++) {
            while (is_space(table, *table->at))
                table->at++;
            if (table->kinds[i] == NUMBER) {
                if (number(table, to) != FOUND || !(*to - *to == 0.0))
                    return 0;
                to++;
            } else if (!text(table, table->kinds[i], &texts))
                return 0;
            const char *behind = table->at;
            while (is_space(table, *table->at))
                table->at++;
            if (i + 1 == table->width)
                break;
            if (table->separator == ' ' ? table->at == behind : *table->at++ != table->separator)
                return 0;
        }
        if (table->at == table->end)
            return 1;
        if (*table->at == '\r')
            table->at++;
        if (*table->at++ != '\n')
            return 0;
    }
    return table->at == table->end;
}

static Py_ssize_t lines_in(const char *at, const char *end) {
    Py_ssize_t count = at < end && end[-1] != '\n';
    for (; at < end; at++)
        count += *at == '\n';
    return count;
}

static PyObject *texts_of(const Table *table, Py_ssize_t rows, Py_ssize_t columns) {
    PyObject *all = PyList_New(columns ? rows : 0);
    const Py_ssize_t *place = table->texts;
    for (Py_ssize_t i = 0; all && columns && i < rows; i++) {
        PyObject *row = PyList_New(columns);
        for (Py_ssize_t j = 0; row && j < columns; j++, place += 2) {
            PyObject *cell = PyUnicode_FromStringAndSize(table->begin + place[0], place[1]);
            if (!cell || PyList_SetItem(row, j, cell) < 0)
                Py_CLEAR(row);
        }
        if (!row || PyList_SetItem(all, i, row) < 0)
            Py_CLEAR(all);
    }
    return all;
}

static PyObject *rows_in(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    Table table = {0};
    char *separator;
    Py_ssize_t size, one, numbers = 0, texts = 0;
    (void)self;
    if (count != 3 || !PyBytes_Check(args[0]) || !PyBytes_Check(args[1]) || !PyBytes_Check(args[2])) {
        PyErr_SetString(PyExc_TypeError, "rows_in(text, separator, kinds): expected bytes");
        return NULL;
    }
    if (PyBytes_AsStringAndSize(args[0], (char **)&table.begin, &size) < 0 ||
        PyBytes_AsStringAndSize(args[1], &separator, &one) < 0 ||
        PyBytes_AsStringAndSize(args[2], (char **)&table.kinds, &table.width) < 0)
        return NULL;
    for (Py_ssize_t i = 0; i < table.width; i++) {
        if (table.kinds[i] < 0 || table.kinds[i] >= KINDS)
            table.width = 0;
        numbers += table.kinds[i] == NUMBER;
        texts += table.kinds[i] == TEXT;
    }
    if (one != 1 || !*separator || !strchr(", ;\t", *separator) || !table.width) {
        PyErr_SetString(PyExc_ValueError, "found another separator or other kinds of columns");
        return NULL;
    }
    decimal_begin();
    table.separator = *separator;
    table.at = table.begin;
    table.end = table.begin + size;
    npy_intp shape[] = {lines_in(table.begin, table.end), numbers};
    /* A row has a sign at least between its cells and at its end: what is shorter is none, and takes no memory. */
    if (shape[0] && (size + 1) / shape[0] < table.width)
        Py_RETURN_NONE;
    if (!PyArray_API) {
        PyErr_SetString(PyExc_RuntimeError, "with_arrays() comes first");
        return NULL;
    }
    PyObject *all = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0), *cells = NULL, *answer = NULL;
    if (!all)
        return NULL;
    table.numbers = PyArray_DATA((PyArrayObject *)all);
    table.texts = texts ? malloc(2 * sizeof(Py_ssize_t) * (size_t)(shape[0] * texts + 1)) : NULL;
    if (texts && !table.texts) {
        PyErr_NoMemory();
        goto end;
    }
    int plain;
    if (size < MANY) {
        plain = read_rows(&table);
    } else {
        Py_BEGIN_ALLOW_THREADS
        plain = read_rows(&table);
        Py_END_ALLOW_THREADS
    }
    if (!plain) {
        answer = Py_None;
        Py_INCREF(answer);
        goto end;
    }
    cells = texts_of(&table, shape[0], texts);
    if (cells)
        answer = PyTuple_Pack(3, all, cells, table.points ? Py_True : Py_False);
end:
    Py_DECREF(all);
    Py_XDECREF(cells);
    free(table.texts);
    return answer;
}

static char *written(char *to, const double *from, npy_intp m, npy_intp width) {
    for (npy_intp i = 0; i < m; i++) {
        for (npy_intp j = 0; j < width; j++) {
            to = decimal_write(to, *from++);
            *to++ = ',';
        }
        to[width ? -1 : 0] = '\n';
        to += !width;
    }
    return to;
}

static PyObject *text_of_rows(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy, *answer = NULL;
    (void)self;
    PyArrayObject *table = count == 1 ? doubles(args[0], 2, &copy) : NULL;
    if (!table || PyArray_NDIM(table) != 2) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "text_of_rows(table): expected an array (m, k)");
        if (table)
            Py_XDECREF(copy);
        return NULL;
    }
    decimal_begin();
    npy_intp m = PyArray_DIM(table, 0), width = PyArray_DIM(table, 1);
    const double *from = PyArray_DATA(table);
    size_t row = (size_t)width * (MOST_CHARACTERS + 1) + 1;
    char *kept = (size_t)m < SIZE_MAX / row ? malloc((size_t)m * row + MOST_TOUCHED) : NULL, *end;
    if (!kept) {
        Py_XDECREF(copy);
        return PyErr_NoMemory();
    }
    if (m * width < LONG) {
        end = written(kept, from, m, width);
    } else {
        Py_BEGIN_ALLOW_THREADS
        end = written(kept, from, m, width);
        Py_END_ALLOW_THREADS
    }
    answer = PyBytes_FromStringAndSize(kept, end - kept);
    free(kept);
    Py_XDECREF(copy);
    return answer;
}

PyMethodDef number_text_methods[] = {
    {"rows_in", (PyCFunction)(void (*)(void))rows_in, METH_FASTCALL,
     "rows_in(text, separator, kinds): numbers (m, k), cells that go through, whether there are points; None"},
    {"text_of_rows", (PyCFunction)(void (*)(void))text_of_rows, METH_FASTCALL, "text_of_rows(table): a line each"},
    {NULL, NULL, 0, NULL},
};
