/* What a unit is in any version of FMI: the generated model, the input that is held, and steps. */
#ifndef UNIT_H
#define UNIT_H

#include "identity.h"

#include <math.h>
#include <stddef.h>

#define INPUT 0U
#define OUTPUT 1U

/* Share of a sampling period by which a step may differ from a whole number of them. */
#define TOLERANCE 1e-6

/* Sampling periods that a step may not reach: more would not fit an unsigned long everywhere. */
#define LONGEST 1e9

typedef struct {
    FMU_MODEL(state) state;
    double input;
} running;

static void start(running *now)
{
    FMU_MODEL(reset)(&now->state);
    now->input = FMU_INPUT_START;
}

static double output(const running *now)
{
    return FMU_MODEL(output)(&now->state, now->input);
}

/* Pass a whole number of sampling periods; return NULL, or why that fails. */
static const char *pass(running *now, double length)
{
    const double periods = length / FMU_PERIOD;
    const unsigned long count =
        ((periods > 0.0) && (periods < LONGEST)) ? (unsigned long)(periods + 0.5) : 0UL;
    const double excess = periods - (double)count;
    const char *failure = NULL;
    unsigned long i;

    if ((count == 0UL) || (excess > TOLERANCE) || (excess < -TOLERANCE)) {
        failure = "a step is a whole number of sampling periods";
    }
    for (i = 0UL; (i < count) && (failure == NULL); i++) {
        (void)FMU_MODEL(step)(&now->state, now->input);
        if (!isfinite(output(now))) {
            failure = "the model diverged";
        }
    }
    return failure;
}

#endif
