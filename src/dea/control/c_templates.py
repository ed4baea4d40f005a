"""Text of the generated C files, in braces what depends on the model."""

HEADER = """\
/* {name}: a polynomial NARX model, sampled at {rate:.17g} Hz.
 *
{equation}
 *
 * Stability on inputs like those of the record that it was selected from: {status}.
 *
 * C99. All state is in {name}_state, which the caller owns; nothing is allocated, and each call
 * takes the same time. Inputs and outputs are in physical units, the state in those of the
 * equation. Generated from the model's file: change the model and generate again.
 */
#ifndef DEA_NARX_{guard}_H
#define DEA_NARX_{guard}_H

#include <stdbool.h>

#define {guard}_SAMPLING_PERIOD ({period}) /* s */
#define {guard}_INPUTS ({inputs}) /* past inputs kept */
#define {guard}_OUTPUTS ({outputs}) /* past outputs kept */

typedef struct {{
    double u[{guard}_INPUTS]; /* u(t-1), u(t-2), ... */
    double y[{guard}_OUTPUTS]; /* y(t-1), y(t-2), ... */
    bool diverged; /* an output left the range that the model is computed in */
}} {name}_state;

/* Rest at the operating point: all past inputs and outputs are their offsets. Call it first. */
void {name}_reset({name}_state *state);

/* y(t) from the past and the input u(t); the state stays. Infinite once the model has diverged, and
 * where an input is not a finite number. */
double {name}_output(const {name}_state *state, double input);

/* One sample of the free run: returns y(t), which becomes the past of the next sample. An input
 * that is not a finite number is divergence. */
double {name}_step({name}_state *state, double input);

/* One measured sample: it becomes the past of the next. In place of an output that is missing (not
 * a number), infinite or beyond the range of the model, its prediction does. The input must be a
 * finite number. A model that diverged needs a reset. */
void {name}_observe({name}_state *state, double input, double output);

#endif
"""

SOURCE = """\
/* {name}: see model.h. */
#include "model.h"

#include <math.h>
#include <stddef.h>

/* The equation holds for (input - U_OFFSET)/U_SCALE and (output - Y_OFFSET)/Y_SCALE. */
static const double U_OFFSET = {u_offset};
static const double U_SCALE = {u_scale};
static const double Y_OFFSET = {y_offset};
static const double Y_SCALE = {y_scale};

/* Beyond it, in the units of the equation, the model has diverged. */
static const double BOUND = {bound};

static const double theta[{count}] = {{
{parameters}
}};

static void keep({name}_state *state, double u, double y)
{{
    size_t i;

    for (i = {guard}_INPUTS - 1U; i > 0U; i--) {{
        state->u[i] = state->u[i - 1U];
    }}
    for (i = {guard}_OUTPUTS - 1U; i > 0U; i--) {{
        state->y[i] = state->y[i - 1U];
    }}
    state->u[0] = u;
    state->y[0] = y;
}}

/* y(t) in the units of the equation. */
static double equation(const {name}_state *state, double input)
{{
{lags}
    double y0 = 0.0;

{sum}

    return y0;
}}

static bool in_range(double y)
{{
    return (y >= -BOUND) && (y <= BOUND);
}}

void {name}_reset({name}_state *state)
{{
    size_t i;

    for (i = 0U; i < {guard}_INPUTS; i++) {{
        state->u[i] = 0.0;
    }}
    for (i = 0U; i < {guard}_OUTPUTS; i++) {{
        state->y[i] = 0.0;
    }}
    state->diverged = false;
}}

double {name}_output(const {name}_state *state, double input)
{{
    const double y0 = equation(state, input);
    double output = HUGE_VAL;

    if ((!state->diverged) && in_range(y0)) {{
        output = (y0 * Y_SCALE) + Y_OFFSET;
    }}
    return output;
}}

double {name}_step({name}_state *state, double input)
{{
    const double y0 = equation(state, input);
    double output = HUGE_VAL;

    if ((!state->diverged) && in_range(y0)) {{
        keep(state, (input - U_OFFSET) / U_SCALE, y0);
        output = (y0 * Y_SCALE) + Y_OFFSET;
    }} else {{
        state->diverged = true;
    }}
    return output;
}}

void {name}_observe({name}_state *state, double input, double output)
{{
    double y0 = (output - Y_OFFSET) / Y_SCALE;

    if (!in_range(y0)) {{
        y0 = equation(state, input);
    }}
    keep(state, (input - U_OFFSET) / U_SCALE, y0);
}}
"""
