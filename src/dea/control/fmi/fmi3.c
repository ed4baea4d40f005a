/* The generated model as a co-simulation unit of FMI 3.0: time, the input and the output.
 *
 * The output at a communication point is y(t) of the equation; a step passes one sampling period
 * or several, through which the input is held. The standard leaves the memory of an instance to
 * the unit, which takes it when it is made; the model itself allocates nothing. */
#include "fmi3.h"
#include "unit.h"

#include <stdlib.h>
#include <string.h>

#define TIME 2U

typedef struct {
    running model;
    double time;
} memory;

typedef struct {
    memory now;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} unit;

static void begin(memory *now)
{
    start(&now->model);
    now->time = 0.0;
}

static void say(fmi3LogMessageCallback log, fmi3InstanceEnvironment environment,
                fmi3String message)
{
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", message);
    }
}

static fmi3Status fail(const unit *model, fmi3String message)
{
    say(model->log, model->environment, message);
    return fmi3Error;
}

FMI3_Export const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

FMI3_Export fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count,
                                           const fmi3String categories[])
{
    (void)instance;
    (void)on;
    (void)count;
    (void)categories;
    return fmi3OK;
}

FMI3_Export fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference intermediate[], size_t intermediates,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update)
{
    unit *model = NULL;

    (void)name;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)early;
    (void)intermediate;
    (void)update;
    if ((token == NULL) || (strcmp(token, FMU_GUID) != 0)) {
        say(log, environment, "the token is that of another model");
    } else if (events || (intermediates != 0U)) {
        say(log, environment, "the unit has neither events nor intermediate variables");
    } else {
        model = calloc(1U, sizeof(unit));
    }
    if (model != NULL) {
        model->environment = environment;
        model->log = log;
        begin(&model->now);
    }
    return model;
}

FMI3_Export fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                      fmi3String resources, fmi3Boolean visible,
                                                      fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    say(log, environment, "the unit is for co-simulation");
    return NULL;
}

FMI3_Export fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)update;
    (void)lock;
    (void)unlock;
    say(log, environment, "the unit is for co-simulation");
    return NULL;
}

FMI3_Export void fmi3FreeInstance(fmi3Instance instance)
{
    free(instance);
}

FMI3_Export fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerant,
                                                   fmi3Float64 tolerance, fmi3Float64 first,
                                                   fmi3Boolean ends, fmi3Float64 last)
{
    unit *model = instance;

    (void)tolerant;
    (void)tolerance;
    (void)ends;
    (void)last;
    model->now.time = first;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3Terminate(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3Reset(fmi3Instance instance)
{
    unit *model = instance;

    begin(&model->now);
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3GetFloat64(fmi3Instance instance,
                                      const fmi3ValueReference references[], size_t count,
                                      fmi3Float64 values[], size_t room)
{
    const unit *model = instance;
    fmi3Status status = (room < count) ? fail(model, "there is no room for the values") : fmi3OK;
    size_t i;

    for (i = 0U; (i < count) && (status == fmi3OK); i++) {
        if (references[i] == INPUT) {
            values[i] = model->now.model.input;
        } else if (references[i] == OUTPUT) {
            values[i] = output(&model->now.model);
        } else if (references[i] == TIME) {
            values[i] = model->now.time;
        } else {
            status = fail(model, "there is no variable of this reference");
        }
    }
    return status;
}

FMI3_Export fmi3Status fmi3SetFloat64(fmi3Instance instance,
                                      const fmi3ValueReference references[], size_t count,
                                      const fmi3Float64 values[], size_t given)
{
    unit *model = instance;
    fmi3Status status = (given < count) ? fail(model, "values are missing") : fmi3OK;
    size_t i;

    for (i = 0U; (i < count) && (status == fmi3OK); i++) {
        if (references[i] == INPUT) {
            model->now.model.input = values[i];
        } else {
            status = fail(model, "the input alone can be set");
        }
    }
    return status;
}

FMI3_Export fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 length,
                                  fmi3Boolean final, fmi3Boolean *event, fmi3Boolean *terminate,
                                  fmi3Boolean *early, fmi3Float64 *reached)
{
    unit *model = instance;
    const char *failure = pass(&model->now.model, length);

    (void)final;
    *event = false;
    *terminate = false;
    *early = false;
    *reached = time;
    if (failure != NULL) {
        return fail(model, failure);
    }
    model->now.time = time + length;
    *reached = model->now.time;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *kept)
{
    const unit *model = instance;
    fmi3Status status = fmi3OK;

    if (*kept == NULL) {
        *kept = malloc(sizeof(memory));
    }
    if (*kept == NULL) {
        status = fail(model, "there is no memory for the state");
    } else {
        (void)memcpy(*kept, &model->now, sizeof(memory));
    }
    return status;
}

FMI3_Export fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState kept)
{
    unit *model = instance;

    (void)memcpy(&model->now, kept, sizeof(memory));
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *kept)
{
    (void)instance;
    free(*kept);
    *kept = NULL;
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState kept,
                                                  size_t *size)
{
    (void)instance;
    (void)kept;
    *size = sizeof(memory);
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState kept,
                                             fmi3Byte bytes[], size_t size)
{
    if (size < sizeof(memory)) {
        return fail(instance, "there is no room for the state");
    }
    (void)memcpy(bytes, kept, sizeof(memory));
    return fmi3OK;
}

FMI3_Export fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[],
                                               size_t size, fmi3FMUState *kept)
{
    if (size != sizeof(memory)) {
        return fail(instance, "these bytes are not a state of this model");
    }
    if (fmi3GetFMUState(instance, kept) != fmi3OK) {
        return fmi3Error;
    }
    (void)memcpy(*kept, bytes, sizeof(memory));
    return fmi3OK;
}

/* The standard wants every function exported. The rest of them are of types, kinds of simulation
 * and modes that the unit does not have. */
#define REFERENCES const fmi3ValueReference references[], size_t count
#define REFUSED(function, ...)                                                                     \
    FMI3_Export fmi3Status function(fmi3Instance instance, __VA_ARGS__)                            \
    {                                                                                              \
        return fail(instance, #function " is of no use to this unit");                             \
    }
#define REFUSED_BARE(function)                                                                     \
    FMI3_Export fmi3Status function(fmi3Instance instance)                                         \
    {                                                                                              \
        return fail(instance, #function " is of no use to this unit");                             \
    }
#define NO_VARIABLES_OF(type)                                                                      \
    REFUSED(fmi3Get##type, REFERENCES, fmi3##type values[], size_t room)                           \
    REFUSED(fmi3Set##type, REFERENCES, const fmi3##type values[], size_t given)

NO_VARIABLES_OF(Float32)
NO_VARIABLES_OF(Int8)
NO_VARIABLES_OF(UInt8)
NO_VARIABLES_OF(Int16)
NO_VARIABLES_OF(UInt16)
NO_VARIABLES_OF(Int32)
NO_VARIABLES_OF(UInt32)
NO_VARIABLES_OF(Int64)
NO_VARIABLES_OF(UInt64)
NO_VARIABLES_OF(Boolean)
NO_VARIABLES_OF(String)
REFUSED(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t room)
REFUSED(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t given)
REFUSED(fmi3GetClock, REFERENCES, fmi3Clock values[])
REFUSED(fmi3SetClock, REFERENCES, const fmi3Clock values[])
REFUSED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *dependencies)
REFUSED(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elements[],
        fmi3ValueReference independents[], size_t others[], fmi3DependencyKind kinds[],
        size_t dependencies)
REFUSED(fmi3GetDirectionalDerivative, const fmi3ValueReference unknowns[], size_t unknown,
        const fmi3ValueReference knowns[], size_t known, const fmi3Float64 seed[], size_t seeds,
        fmi3Float64 sensitivity[], size_t room)
REFUSED(fmi3GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t unknown,
        const fmi3ValueReference knowns[], size_t known, const fmi3Float64 seed[], size_t seeds,
        fmi3Float64 sensitivity[], size_t room)
REFUSED(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
        size_t room)
REFUSED(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[],
        fmi3IntervalQualifier qualifiers[])
REFUSED(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
        fmi3IntervalQualifier qualifiers[])
REFUSED(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
REFUSED(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
REFUSED(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
REFUSED(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[],
        const fmi3UInt64 resolutions[])
REFUSED(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
REFUSED(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[],
        const fmi3UInt64 resolutions[])
REFUSED(fmi3UpdateDiscreteStates, fmi3Boolean *needed, fmi3Boolean *terminate,
        fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
REFUSED(fmi3CompletedIntegratorStep, fmi3Boolean final, fmi3Boolean *event,
        fmi3Boolean *terminate)
REFUSED(fmi3SetTime, fmi3Float64 time)
REFUSED(fmi3SetContinuousStates, const fmi3Float64 states[], size_t count)
REFUSED(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t count)
REFUSED(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t count)
REFUSED(fmi3GetContinuousStates, fmi3Float64 states[], size_t count)
REFUSED(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t count)
REFUSED(fmi3GetNumberOfEventIndicators, size_t *count)
REFUSED(fmi3GetNumberOfContinuousStates, size_t *count)
REFUSED(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
REFUSED_BARE(fmi3EnterEventMode)
REFUSED_BARE(fmi3EnterConfigurationMode)
REFUSED_BARE(fmi3ExitConfigurationMode)
REFUSED_BARE(fmi3EvaluateDiscreteStates)
REFUSED_BARE(fmi3EnterContinuousTimeMode)
