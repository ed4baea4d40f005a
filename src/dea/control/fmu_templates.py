"""Text of the files in a functional mock-up unit, in braces what depends on the model."""

DESCRIPTION_2 = """\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription
  fmiVersion="2.0"
  modelName={name}
  guid={guid}
  description="Polynomial NARX model"
  generationTool="dea-study"
  variableNamingConvention="flat"
  numberOfEventIndicators="0">
  <CoSimulation
    modelIdentifier={name}
    canHandleVariableCommunicationStepSize="false"
    canBeInstantiatedOnlyOncePerProcess="false"
    canGetAndSetFMUstate="true"
    canSerializeFMUstate="true">
    <SourceFiles>
      <File name="model.c"/>
      <File name="fmi2.c"/>
    </SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
{units}
  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError"/>
  </LogCategories>
  <DefaultExperiment startTime="0" stopTime={stop} stepSize={period}/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input" variability="discrete">
      <Real start={start} unit={u_units}/>
    </ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="discrete">
      <Real unit={y_units}/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="2" dependencies={known}/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index="2" dependencies={known}/>
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""

DESCRIPTION_3 = """\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription
  fmiVersion="3.0"
  modelName={name}
  instantiationToken={guid}
  description="Polynomial NARX model"
  generationTool="dea-study"
  variableNamingConvention="flat">
  <CoSimulation
    modelIdentifier={name}
    canHandleVariableCommunicationStepSize="false"
    fixedInternalStepSize={period}
    canGetAndSetFMUState="true"
    canSerializeFMUState="true"/>
  <UnitDefinitions>
{units}
  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError"/>
  </LogCategories>
  <DefaultExperiment startTime="0" stopTime={stop} stepSize={period}/>
  <ModelVariables>
    <Float64 name="u" valueReference="0" causality="input" variability="discrete"
      start={start} unit={u_units}/>
    <Float64 name="y" valueReference="1" causality="output" variability="discrete"
      unit={y_units}/>
    <Float64 name="time" valueReference="2" causality="independent" variability="continuous"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="1" dependencies={known}/>
    <InitialUnknown valueReference="1" dependencies={known}/>
  </ModelStructure>
</fmiModelDescription>
"""

# How FMI 3.0 has sources compiled.
BUILD_3 = """\
<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier={name}>
    <SourceFileSet language="C99">
      <SourceFile name="model.c"/>
      <SourceFile name="fmi3.c"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""

IDENTITY = """\
/* The model that {wrapper} wraps. */
#ifndef IDENTITY_H
#define IDENTITY_H

#include "model.h"

#define FMU_MODEL(part) {name}_##part
#define FMU_GUID "{guid}"
#define FMU_INPUT_START ({start})
#define FMU_PERIOD ({guard}_SAMPLING_PERIOD)

#endif
"""
