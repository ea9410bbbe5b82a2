//! modelDescription.xml of FMI 2.0 and 3.0. It names no time, so that equal joints give equal files.

use report::escape::escaped_xml;

use crate::model::{Content, Fmi, Model};
use crate::variables::{Kind, Role, Unit, Variable};

/// Name and version of the tool.
const TOOL: &str = concat!("joint ", env!("CARGO_PKG_VERSION"));

/// Text for an attribute.
fn escaped(text: &str) -> String {
    escaped_xml(&text.replace(char::is_control, " "))
}

/// modelDescription.xml.
pub fn model_description(model: &Model, token: &str) -> String {
    let what = match model.content {
        Content::Plant => "Gears with backlash, motor, frictions, weight and encoders",
        Content::Controller => "Observer and compensation of backlash",
    };
    let description = format!("{what} of joint {}, {} control periods a second", model.joint, model.rate);
    let name = format!("{} {}", model.joint, model.content.name());
    let period = 1.0 / f64::from(model.rate);
    let head = format!(
        "modelName=\"{}\" description=\"{}\" version=\"{}\" generationTool=\"{TOOL}\" \
         variableNamingConvention=\"structured\"",
        escaped(&name),
        escaped(&description),
        env!("CARGO_PKG_VERSION"),
    );
    let units = units(model);
    let experiment = format!("<DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"{period:?}\"/>");
    let categories = "<LogCategories>\n\
        <Category name=\"logStatusError\" description=\"Calls that failed\"/>\n\
        <Category name=\"logStatusDiscard\" description=\"Calls that were refused and changed nothing\"/>\n\
        </LogCategories>";
    let identifier = &model.identifier;
    let variables: String =
        model.variables.iter().enumerate().map(|(index, it)| variable(model.fmi, index, it)).collect();
    match model.fmi {
        Fmi::Two => format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiModelDescription fmiVersion=\"2.0\" guid=\"{token}\" {head} numberOfEventIndicators=\"0\">\n\
             <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" \
             canInterpolateInputs=\"false\" maxOutputDerivativeOrder=\"0\" canRunAsynchronuously=\"false\" \
             canBeInstantiatedOnlyOncePerProcess=\"false\" canNotUseMemoryManagementFunctions=\"true\" \
             canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"false\" providesDirectionalDerivative=\"false\"/>\n\
             {units}{categories}\n{experiment}\n<ModelVariables>\n{variables}</ModelVariables>\n\
             <ModelStructure>\n<Outputs>\n{outputs}</Outputs>\n<InitialUnknowns>\n{outputs}</InitialUnknowns>\n\
             </ModelStructure>\n</fmiModelDescription>\n",
            outputs = outputs(model, |index| format!("<Unknown index=\"{}\" dependencies=\"\"/>\n", index + 1)),
        ),
        Fmi::Three => format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{token}\" {head}>\n\
             <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" \
             canBeInstantiatedOnlyOncePerProcess=\"false\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"false\" \
             fixedInternalStepSize=\"{period:?}\" hasEventMode=\"false\"/>\n\
             {units}{}{categories}\n{experiment}\n<ModelVariables>\n{variables}</ModelVariables>\n\
             <ModelStructure>\n{}{}</ModelStructure>\n</fmiModelDescription>\n",
            types(model),
            outputs(model, |index| format!("<Output valueReference=\"{index}\" dependencies=\"\"/>\n")),
            outputs(model, |index| format!("<InitialUnknown valueReference=\"{index}\" dependencies=\"\"/>\n")),
        ),
    }
}

/// Elements of all outputs.
fn outputs(model: &Model, element: impl Fn(usize) -> String) -> String {
    let all = model.variables.iter().enumerate();
    all.filter(|(_, it)| it.role == Role::Output).map(|(index, _)| element(index)).collect()
}

/// Units of the variables, each once.
fn used_units(model: &Model) -> Vec<Unit> {
    let mut used: Vec<Unit> = vec![];
    for variable in &model.variables {
        if let Kind::Real(unit) = variable.kind
            && !used.contains(&unit)
        {
            used.push(unit);
        }
    }
    used
}

/// A type for each unit, for FMI 3: some importers accept no unit at a variable.
fn types(model: &Model) -> String {
    let line = |unit: &Unit| format!("<Float64Type name=\"{0}\" unit=\"{0}\"/>\n", unit.0);
    format!("<TypeDefinitions>\n{}</TypeDefinitions>\n", used_units(model).iter().map(line).collect::<String>())
}

fn units(model: &Model) -> String {
    let base = |unit: &Unit| {
        let exponents = ["kg", "m", "s", "rad"].iter().zip(unit.1);
        let present = exponents.filter(|(_, exponent)| *exponent != 0);
        present.map(|(name, exponent)| format!(" {name}=\"{exponent}\"")).collect::<String>()
    };
    let line = |unit: &Unit| format!("<Unit name=\"{}\"><BaseUnit{}/></Unit>\n", unit.0, base(unit));
    format!("<UnitDefinitions>\n{}</UnitDefinitions>\n", used_units(model).iter().map(line).collect::<String>())
}

/// Element of a variable, with its index as value reference.
fn variable(fmi: Fmi, index: usize, of: &Variable) -> String {
    let is_real = matches!(of.kind, Kind::Real(_));
    let variability = if is_real { "continuous" } else { "discrete" };
    let (causality, initial, start) = match of.role {
        Role::Independent => ("independent", "", None),
        Role::Input(start) => ("input", "", Some(start)),
        Role::Output => ("output", " initial=\"calculated\"", None),
    };
    let start = start.map_or_else(String::new, |start| match of.kind {
        Kind::Boolean => format!(" start=\"{}\"", start != 0.0),
        Kind::Real(_) | Kind::Integer => format!(" start=\"{start}\""),
    });
    let unit = match of.kind {
        Kind::Real(unit) => format!(" {}=\"{}\"", if fmi == Fmi::Two { "unit" } else { "declaredType" }, unit.0),
        Kind::Integer | Kind::Boolean => String::new(),
    };
    let shared = format!(
        "name=\"{}\" valueReference=\"{index}\" causality=\"{causality}\" variability=\"{variability}\"{initial} \
         description=\"{}\"",
        of.name,
        escaped(&of.description)
    );
    match fmi {
        Fmi::Two => {
            let element = match of.kind {
                Kind::Real(_) => "Real",
                Kind::Integer => "Integer",
                Kind::Boolean => "Boolean",
            };
            format!("<ScalarVariable {shared}><{element}{unit}{start}/></ScalarVariable>\n")
        }
        Fmi::Three => {
            let element = match of.kind {
                Kind::Real(_) => "Float64",
                Kind::Integer => "Int32",
                Kind::Boolean => "Boolean",
            };
            format!("<{element} {shared}{unit}{start}/>\n")
        }
    }
}
