/* The generated model as a co-simulation slave of FMI 2.0, its variables the input and the output.
 *
 * The output at a communication point is y(t) of the equation; a step passes one sampling period
 * or several, through which the input is held. The standard has the simulator give the memory
 * of an instance; the model itself allocates nothing. */
#include "fmi2.h"
#include "unit.h"

#include <string.h>

typedef struct {
    running now;
    const fmi2CallbackFunctions *simulator;
    char name[64];
} instance;

static fmi2Status fail(const instance *model, fmi2String message)
{
    const fmi2CallbackFunctions *simulator = model->simulator;

    if (simulator->logger != NULL) {
        simulator->logger(simulator->componentEnvironment, model->name, fmi2Error, "logStatusError",
                          message);
    }
    return fmi2Error;
}

/* For variables of types that the model does not have. */
static fmi2Status none_of_type(fmi2Component component, size_t count)
{
    return (count == 0U) ? fmi2OK : fail(component, "the variables of this model are real");
}

FMI2_Export const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

FMI2_Export const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                          fmi2String resources,
                                          const fmi2CallbackFunctions *simulator,
                                          fmi2Boolean visible, fmi2Boolean logging)
{
    instance *model = NULL;

    (void)resources;
    (void)visible;
    (void)logging;
    if ((type == fmi2CoSimulation) && (guid != NULL) && (strcmp(guid, FMU_GUID) == 0) &&
        (simulator != NULL) && (simulator->allocateMemory != NULL)) {
        model = simulator->allocateMemory(1U, sizeof(instance));
    }
    if (model != NULL) {
        model->simulator = simulator;
        model->name[0] = '\0';
        if (name != NULL) {
            (void)strncat(model->name, name, sizeof(model->name) - 1U);
        }
        start(&model->now);
    }
    return model;
}

FMI2_Export void fmi2FreeInstance(fmi2Component component)
{
    instance *model = component;

    if ((model != NULL) && (model->simulator->freeMemory != NULL)) {
        model->simulator->freeMemory(model);
    }
}

FMI2_Export fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                                           const fmi2String categories[])
{
    (void)component;
    (void)on;
    (void)count;
    (void)categories;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerant,
                                           fmi2Real tolerance, fmi2Real first, fmi2Boolean ends,
                                           fmi2Real last)
{
    (void)component;
    (void)tolerant;
    (void)tolerance;
    (void)first;
    (void)ends;
    (void)last;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    (void)component;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    (void)component;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2Terminate(fmi2Component component)
{
    (void)component;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2Reset(fmi2Component component)
{
    instance *model = component;

    start(&model->now);
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[],
                                   size_t count, fmi2Real values[])
{
    const instance *model = component;
    fmi2Status status = fmi2OK;
    size_t i;

    for (i = 0U; i < count; i++) {
        if (references[i] == INPUT) {
            values[i] = model->now.input;
        } else if (references[i] == OUTPUT) {
            values[i] = output(&model->now);
        } else {
            status = fail(model, "there is no variable of this reference");
        }
    }
    return status;
}

FMI2_Export fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[],
                                   size_t count, const fmi2Real values[])
{
    instance *model = component;
    fmi2Status status = fmi2OK;
    size_t i;

    for (i = 0U; i < count; i++) {
        if (references[i] == INPUT) {
            model->now.input = values[i];
        } else {
            status = fail(model, "the input alone can be set");
        }
    }
    return status;
}

FMI2_Export fmi2Status fmi2GetInteger(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      fmi2Integer values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2SetInteger(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      const fmi2Integer values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2GetBoolean(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      fmi2Boolean values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2SetBoolean(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      const fmi2Boolean values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2GetString(fmi2Component component,
                                     const fmi2ValueReference references[], size_t count,
                                     fmi2String values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2SetString(fmi2Component component,
                                     const fmi2ValueReference references[], size_t count,
                                     const fmi2String values[])
{
    (void)references;
    (void)values;
    return none_of_type(component, count);
}

FMI2_Export fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real length,
                                  fmi2Boolean final)
{
    instance *model = component;
    const char *failure = pass(&model->now, length);

    (void)time;
    (void)final;
    return (failure == NULL) ? fmi2OK : fail(model, failure);
}

FMI2_Export fmi2Status fmi2CancelStep(fmi2Component component)
{
    return fail(component, "a step ends before its call returns");
}

FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *kept)
{
    const instance *model = component;
    fmi2Status status = fmi2OK;

    if (*kept == NULL) {
        *kept = model->simulator->allocateMemory(1U, sizeof(running));
    }
    if (*kept == NULL) {
        status = fail(model, "the simulator gave no memory");
    } else {
        (void)memcpy(*kept, &model->now, sizeof(running));
    }
    return status;
}

FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate kept)
{
    instance *model = component;

    (void)memcpy(&model->now, kept, sizeof(running));
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *kept)
{
    const instance *model = component;

    if (*kept != NULL) {
        model->simulator->freeMemory(*kept);
        *kept = NULL;
    }
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate kept,
                                                  size_t *size)
{
    (void)component;
    (void)kept;
    *size = sizeof(running);
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate kept,
                                             fmi2Byte bytes[], size_t size)
{
    if (size < sizeof(running)) {
        return fail(component, "there is no room for the state");
    }
    (void)memcpy(bytes, kept, sizeof(running));
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[],
                                               size_t size, fmi2FMUstate *kept)
{
    if (size != sizeof(running)) {
        return fail(component, "these bytes are not a state of this model");
    }
    if (fmi2GetFMUstate(component, kept) != fmi2OK) {
        return fmi2Error;
    }
    (void)memcpy(*kept, bytes, sizeof(running));
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component component, const fmi2ValueReference unknown[], size_t unknowns,
    const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[], fmi2Real values[])
{
    (void)unknown;
    (void)unknowns;
    (void)known;
    (void)knowns;
    (void)seed;
    (void)values;
    return fail(component, "the model gives no derivatives");
}

FMI2_Export fmi2Status fmi2SetRealInputDerivatives(fmi2Component component,
                                                   const fmi2ValueReference references[],
                                                   size_t count, const fmi2Integer orders[],
                                                   const fmi2Real values[])
{
    (void)references;
    (void)orders;
    (void)values;
    return (count == 0U) ? fmi2OK : fail(component, "the input is held through a step");
}

FMI2_Export fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component,
                                                    const fmi2ValueReference references[],
                                                    size_t count, const fmi2Integer orders[],
                                                    fmi2Real values[])
{
    (void)references;
    (void)orders;
    (void)values;
    return (count == 0U) ? fmi2OK : fail(component, "the model gives no derivatives");
}

FMI2_Export fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind,
                                     fmi2Status *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard; /* no step is ever pending */
}

FMI2_Export fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind,
                                         fmi2Real *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind,
                                            fmi2Integer *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind,
                                            fmi2Boolean *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind,
                                           fmi2String *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}
