#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/types.hpp>

/// Types whose being there, at their place, is a conformance unit (Part 7, Base Information).
namespace busbar::model::unit_types_test {

namespace {

struct PlacedType {
    std::uint32_t type;
    std::uint32_t supertype;
};

void check_places(std::initializer_list<PlacedType> rows)
{
    const AddressSpace space;
    if (space.find(id::RationalNumber) == no_node) {
        return; // a small namespace 0
    }
    for (const PlacedType& row : rows) {
        INFO("i=" << row.type);
        const NodeIndex type = space.find(row.type);
        REQUIRE(type != no_node);
        REQUIRE(space.supertype(type) != no_node);
        CHECK(space.node_id(space.supertype(type)).is(row.supertype));
    }
}

/// The fields of a structure in their order: "Low:11 Elements:583[]", by the number of the
/// DataType.
std::string fields_of(const AddressSpace& space, std::uint32_t structure)
{
    const binary::TypeRegistry types{binary::namespace0_types()};
    const auto kept = space.attribute(space.find(structure), AttributeId::DataTypeDefinition);
    REQUIRE(kept);
    const auto bytes = binary::to_bytes(*kept);
    REQUIRE(bytes);
    const auto decoded = binary::from_bytes<Variant>(*bytes, &types);
    REQUIRE(decoded);
    const auto* const object = decoded->get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    const auto* const definition = object->get_if<StructureDefinition>();
    REQUIRE(definition != nullptr);
    std::string text;
    for (const StructureField& field : definition->fields) {
        text += (text.empty() ? "" : " ") + field.name.str() + ":" +
                std::to_string(field.data_type.numeric()) + (field.value_rank == 1 ? "[]" : "");
    }
    return text;
}

} // namespace

TEST_CASE("Types of references are at their places",
          "[unit:Base Info AssociatedWith][unit:Base Info Controls]"
          "[unit:Base Info Deprecated Information]"
          "[unit:Base Info HasAttachedComponent]"
          "[unit:Base Info HasContainedComponent]"
          "[unit:Base Info HasOrderedComponent]"
          "[unit:Base Info HasPhysicalComponent][unit:Base Info IsExecutableOn]"
          "[unit:Base Info IsExecutingOn][unit:Base Info IsHostedBy]"
          "[unit:Base Info IsPhysicallyConnectedTo]"
          "[unit:Base Info RepresentsSameEntityAs]"
          "[unit:Base Info RepresentsSameFunctionalityAs]"
          "[unit:Base Info RepresentsSameHardwareAs][unit:Base Info Requires]"
          "[unit:Base Info Subvariables of Structures][unit:Base Info Utilizes]")
{
    check_places({{id::AssociatedWith, id::NonHierarchicalReferences},
                  {id::Controls, id::HierarchicalReferences},
                  {id::HasAttachedComponent, id::HasPhysicalComponent},
                  {id::HasContainedComponent, id::HasPhysicalComponent},
                  {id::HasOrderedComponent, id::HasComponent},
                  {id::HasPhysicalComponent, id::HasComponent},
                  {id::HasStructuredComponent, id::HasComponent},
                  {id::IsDeprecated, id::NonHierarchicalReferences},
                  {id::IsExecutableOn, id::NonHierarchicalReferences},
                  {id::IsExecutingOn, id::Utilizes},
                  {id::IsHostedBy, id::Utilizes},
                  {id::IsPhysicallyConnectedTo, id::NonHierarchicalReferences},
                  {id::RepresentsSameEntityAs, id::NonHierarchicalReferences},
                  {id::RepresentsSameFunctionalityAs, id::RepresentsSameEntityAs},
                  {id::RepresentsSameHardwareAs, id::RepresentsSameEntityAs},
                  {id::Requires, id::HierarchicalReferences},
                  {id::Utilizes, id::NonHierarchicalReferences}});
}

TEST_CASE("Types of texts, numbers and images are at their places",
          "[unit:Base Info Audio Type][unit:Base Info BitFieldMaskDataType]"
          "[unit:Base Info Date DataTypes][unit:Base Info Decimal DataType]"
          "[unit:Base Info DecimalString DataType][unit:Base Info Handle DataType]"
          "[unit:Base Info Image DataTypes]"
          "[unit:Base Info NormalizedString DataType]"
          "[unit:Base Info SemanticVersionString][unit:Base Info TrimmedString]"
          "[unit:Base Info UriString]")
{
    check_places({{id::AudioVariableType, id::BaseDataVariableType},
                  {id::BitFieldMaskDataType, id::UInt64},
                  {id::DateString, id::String},
                  {id::Decimal, id::Number},
                  {id::DecimalString, id::String},
                  {id::DurationString, id::String},
                  {id::Handle, id::UInt32},
                  {id::Image, id::ByteString},
                  {id::ImageBMP, id::Image},
                  {id::ImageGIF, id::Image},
                  {id::ImageJPG, id::Image},
                  {id::ImagePNG, id::Image},
                  {id::NormalizedString, id::String},
                  {id::SemanticVersionString, id::String},
                  {id::TimeString, id::String},
                  {id::TrimmedString, id::String},
                  {id::UriString, id::String}});
}

TEST_CASE("Types of structures are at their places",
          "[unit:Base Info ContentFilter][unit:Base Info EUInformation]"
          "[unit:Base Info KeyValuePair][unit:Base Info Method Argument DataType]"
          "[unit:Base Info OptionSet DataType][unit:Base Info OrderedList]"
          "[unit:Base Info Portable IDs][unit:Base Info Range DataType]"
          "[unit:Base Info Rational Number][unit:Base Info ReferenceDescription]"
          "[unit:Base Info Spatial Data][unit:Base Info StatusResult DataType]"
          "[unit:Base Info UaBinary File][unit:Data Access Complex Number]"
          "[unit:Data Access DoubleComplex Number]"
          "[unit:Data Access AxisInformationType]")
{
    check_places({{id::Argument, id::Structure},
                  {id::AxisInformation, id::Structure},
                  {id::ComplexNumberType, id::Structure},
                  {id::ContentFilter, id::Structure},
                  {id::DoubleComplexNumberType, id::Structure},
                  {id::EUInformation, id::Structure},
                  {id::KeyValuePair, id::Structure},
                  {id::OptionSet, id::Structure},
                  {id::OptionSetType, id::BaseDataVariableType},
                  {id::OrderedListType, id::BaseObjectType},
                  {id::PortableNodeId, id::Structure},
                  {id::PortableQualifiedName, id::Structure},
                  {id::Range, id::Structure},
                  {id::RationalNumber, id::Structure},
                  {id::RationalNumberType, id::BaseDataVariableType},
                  {id::ReferenceDescriptionDataType, id::Structure},
                  {id::StatusResult, id::Structure},
                  {id::ThreeDCartesianCoordinates, id::CartesianCoordinates},
                  {id::ThreeDFrame, id::Frame},
                  {id::ThreeDOrientation, id::Orientation},
                  {id::ThreeDVector, id::Vector},
                  {id::UABinaryFileDataType, id::DataTypeSchemaHeader}});
    const AddressSpace space;
    if (space.find(id::RationalNumber) == no_node) {
        return;
    }
    const std::pair<std::uint32_t, const char*> rows[] = {
        {id::Argument, "Name:12 DataType:17 ValueRank:6 ArrayDimensions:7[] Description:21"},
        {id::AxisInformation,
         "EngineeringUnits:887 EURange:884 Title:21 AxisScaleType:12077 AxisSteps:11[]"},
        {id::ComplexNumberType, "Real:10 Imaginary:10"},
        {id::ContentFilter, "Elements:583[]"},
        {id::DoubleComplexNumberType, "Real:11 Imaginary:11"},
        {id::EUInformation, "NamespaceUri:12 UnitId:6 DisplayName:21 Description:21"},
        {id::KeyValuePair, "Key:20 Value:24"},
        {id::OptionSet, "Value:15 ValidBits:15"},
        {id::PortableNodeId, "NamespaceUri:12 Identifier:17"},
        {id::PortableQualifiedName, "NamespaceUri:12 Name:12"},
        {id::Range, "Low:11 High:11"},
        {id::RationalNumber, "Numerator:6 Denominator:7"},
        {id::ReferenceDescriptionDataType,
         "SourceNode:17 ReferenceType:17 IsForward:1 TargetNode:18"},
        {id::StatusResult, "StatusCode:19 DiagnosticInfo:25"},
        {id::ThreeDVector, "X:11 Y:11 Z:11"},
        {id::UABinaryFileDataType,
         "Namespaces:12[] StructureDataTypes:15487[] EnumDataTypes:15488[] SimpleDataTypes:15005[] "
         "SchemaLocation:12 FileHeader:14533[] Body:24"},
    };
    for (const auto& [structure, fields] : rows) {
        INFO("i=" << structure);
        CHECK(fields_of(space, structure) == fields);
    }
}

TEST_CASE("Folders of types, base types and ModellingRules are where clients look for them",
          "[unit:Base Info Base Types][unit:Base Info Core Types Folders]"
          "[unit:Base Info Core Views Folder][unit:Base Info Locations Object]"
          "[unit:Base Info Placeholder Modelling Rules][unit:Base Info ServerType]")
{
    const AddressSpace space;
    const bool is_full = space.find(id::RationalNumber) != no_node;
    for (const std::uint32_t folder :
         {id::RootFolder, id::ObjectsFolder, id::TypesFolder, id::ViewsFolder,
          id::ObjectTypesFolder, id::VariableTypesFolder, id::DataTypesFolder,
          id::ReferenceTypesFolder}) {
        INFO("i=" << folder);
        REQUIRE(space.find(folder) != no_node);
        CHECK(space.node_id(space.type_definition(space.find(folder))).is(id::FolderType));
    }
    for (const std::uint32_t type :
         {id::BaseObjectType, id::BaseVariableType, id::BaseDataType, id::References}) {
        INFO("i=" << type);
        REQUIRE(space.find(type) != no_node);
        CHECK(space.supertype(space.find(type)) == no_node);
    }
    check_places({{id::Boolean, id::BaseDataType},
                  {id::Byte, id::UInteger},
                  {id::Double, id::Number},
                  {id::Enumeration, id::BaseDataType},
                  {id::Float, id::Number},
                  {id::Int32, id::Integer},
                  {id::Integer, id::Number},
                  {id::LocalizedText, id::BaseDataType},
                  {id::Number, id::BaseDataType},
                  {id::String, id::BaseDataType},
                  {id::Structure, id::BaseDataType},
                  {id::UInteger, id::Number},
                  {id::BaseDataVariableType, id::BaseVariableType},
                  {id::FolderType, id::BaseObjectType},
                  {id::PropertyType, id::BaseVariableType}});
    if (is_full) {
        const std::pair<std::uint32_t, std::uint32_t> objects[] = {
            {id::EventTypesFolder, id::FolderType},
            {id::Locations, id::FolderType},
            {id::ModellingRule_MandatoryPlaceholder, id::ModellingRuleType},
            {id::ModellingRule_OptionalPlaceholder, id::ModellingRuleType}};
        for (const auto& [object, type] : objects) {
            INFO("i=" << object);
            REQUIRE(space.find(object) != no_node);
            CHECK(space.node_id(space.type_definition(space.find(object))).is(type));
        }
        const NodeIndex server = space.find(id::Server);
        CHECK(space.node_id(space.type_definition(server)).is(id::ServerType));
        CHECK(space.node_id(space.supertype(space.find(id::ServerType))).is(id::BaseObjectType));
    }
}

} // namespace busbar::model::unit_types_test
