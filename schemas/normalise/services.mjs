// The service types stand only in the binary schema; they are made into data type nodes here.
import { childrenOf, readXml } from "./xml.mjs";

const basicTypes = {
  "opc:Boolean": 1,
  "opc:SByte": 2,
  "opc:Byte": 3,
  "opc:Int16": 4,
  "opc:UInt16": 5,
  "opc:Int32": 6,
  "opc:UInt32": 7,
  "opc:Int64": 8,
  "opc:UInt64": 9,
  "opc:Float": 10,
  "opc:Double": 11,
  "opc:CharArray": 12,
  "opc:String": 12,
  "opc:DateTime": 13,
  "opc:Guid": 14,
  "opc:ByteString": 15,
  "ua:XmlElement": 16,
  "ua:NodeId": 17,
  "ua:ExpandedNodeId": 18,
  "ua:StatusCode": 19,
  "ua:QualifiedName": 20,
  "ua:LocalizedText": 21,
  "ua:ExtensionObject": 22,
  "ua:DataValue": 23,
  "ua:Variant": 24,
  "ua:DiagnosticInfo": 25,
};
const structure = 22;
const enumeration = 29;

const fieldAttributes = (type) => childrenOf(type, "opc:Field").map((f) => f.attributes);

/** Names of the fields that a type has from its supertypes: not all of them have a SourceType. */
function inheritedNames(type, typesByName) {
  const base = typesByName.get(type.attributes.BaseType?.replace(/^tns:/, ""));
  return base
    ? fieldAttributes(base)
        .map((f) => f.Name)
        .concat(inheritedNames(base, typesByName))
    : [];
}

function fieldsOf(type, typesByName, idOf) {
  const fields = fieldAttributes(type);
  const lengths = new Set(fields.map((f) => f.LengthField).filter(Boolean));
  const inherited = new Set(inheritedNames(type, typesByName));
  return fields
    .filter((f) => !lengths.has(f.Name) && f.SourceType === undefined && !inherited.has(f.Name))
    .map((f) => ({
      name: f.Name,
      dataType: `i=${idOf(f.TypeName)}`,
      valueRank: f.LengthField ? "1" : undefined,
    }));
}

function dataType(id, browseName, supertype, definition) {
  return {
    element: "UADataType",
    id,
    browseName,
    displayName: browseName,
    inverseName: "",
    attributes: {},
    references: [{ type: 45, forward: false, target: supertype }],
    definition,
  };
}

function encoding(id, typeId) {
  return {
    element: "UAObject",
    id,
    browseName: "Default Binary",
    displayName: "Default Binary",
    inverseName: "",
    attributes: {},
    references: [
      { type: 40, forward: true, target: 76 },
      { type: 38, forward: false, target: typeId },
    ],
  };
}

const value = (name, children, text = "") => ({ name, children, text });
const localizedText = (name, text) => value(name, [value("Text", [], text)]);

function enumValue({ name, value: number }) {
  const identifier = value("TypeId", [value("Identifier", [], "i=7616")]);
  const content = [value("Value", [], number), localizedText("DisplayName", name)];
  return value("ExtensionObject", [identifier, value("Body", [value("EnumValueType", content)])]);
}

function namesProperty(id, browseName, typeId, dataType, list) {
  return {
    element: "UAVariable",
    id,
    browseName,
    displayName: browseName,
    inverseName: "",
    attributes: { DataType: `i=${dataType}`, ValueRank: "1", ArrayDimensions: `${list.length}` },
    references: [
      { type: 40, forward: true, target: 68 },
      { type: 46, forward: false, target: typeId },
    ],
    value: value(dataType === 21 ? "ListOfLocalizedText" : "ListOfExtensionObject", list),
  };
}

/** The Property with an enumeration's names; the constants have its id, no package has the node. */
function enumerationNames(name, typeId, fields, constants) {
  const strings = constants.VariableIds[`${name}_EnumStrings`];
  if (strings !== undefined) {
    const texts = fields.map((field) => localizedText("LocalizedText", field.name));
    return namesProperty(strings, "EnumStrings", typeId, 21, texts);
  }
  const values = constants.VariableIds[`${name}_EnumValues`];
  if (values !== undefined)
    return namesProperty(values, "EnumValues", typeId, 7594, fields.map(enumValue));
  return undefined;
}

/** Data types of the binary schema that `nodes` does not have, with their encodings and names. */
export function readServiceTypes(file, modules, nodes, constants) {
  const root = readXml(file, modules);
  const known = new Map(
    [...nodes.values()].filter((n) => n.element === "UADataType").map((n) => [n.browseName, n.id]),
  );
  const idOf = (typeName) => {
    const name = typeName.replace(/^\w+:/, "");
    const id = basicTypes[typeName] ?? constants.DataTypeIds[name] ?? known.get(name);
    if (id === undefined) throw new Error(`${file}: the type ${typeName} has no id`);
    return id;
  };
  const typesByName = new Map(root.children.map((type) => [type.attributes.Name, type]));
  const result = new Map();
  for (const type of root.children) {
    const name = type.attributes.Name;
    const isStructure = type.name === "opc:StructuredType";
    if (
      (!isStructure && type.name !== "opc:EnumeratedType") ||
      known.has(name) ||
      constants.DataTypeIds[name] === undefined
    ) {
      continue;
    }
    const id = constants.DataTypeIds[name];
    if (nodes.has(id)) continue; // under another name: 3DVector is ThreeDVector in the schema
    const base = type.attributes.BaseType;
    const supertype = isStructure
      ? base && base !== "ua:ExtensionObject"
        ? idOf(base)
        : structure
      : enumeration;
    const fields = isStructure
      ? fieldsOf(type, typesByName, idOf)
      : childrenOf(type, "opc:EnumeratedValue").map((v) => ({
          name: v.attributes.Name,
          value: v.attributes.Value,
        }));
    result.set(id, dataType(id, name, supertype, { fields }));
    const names = isStructure ? undefined : enumerationNames(name, id, fields, constants);
    if (names !== undefined) result.set(names.id, names);
    const binary = constants.ObjectIds[`${name}_Encoding_DefaultBinary`];
    if (isStructure && binary !== undefined) result.set(binary, encoding(binary, id));
  }
  return result;
}
