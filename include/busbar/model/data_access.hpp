#pragma once

#include <optional>

#include <busbar/core/api.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/model/units.hpp>
#include <busbar/types/ids.hpp>

/// Adds Variables of Data Access (Part 8, 5.3) in one call each:
///
///     AnalogItem level;
///     level.variable.data_type = NodeId{0, id::Double};
///     level.eu_range = Range{0, 400};
///     level.engineering_units = engineering_units("CMT");
///     add_analog_item(space, node, level);
///
/// Each function creates an instance of its VariableType (instance.hpp describes the errors and the
/// NodeIds of the Properties) and gives the Properties their values. `variable` has the usual
/// attributes; its type_definition is ignored, and a null data_type and a value_rank of -2 are
/// replaced as the function describes. Namespace 0 must have the types: else
/// Bad_TypeDefinitionInvalid.
namespace busbar::model {

/// The common properties of every DataItemType (Part 8, 5.3.1.2).
struct DataItem {
    NewVariable variable;
    /// Describes how the value is computed; if null, the Property is left out.
    String definition;
    std::optional<double> value_precision;
};

/// AnalogItemType, AnalogUnitType or AnalogUnitRangeType (Part 8, 5.3.2).
struct AnalogItem : DataItem {
    /// Required, except for AnalogUnitType.
    std::optional<Range> eu_range;
    /// Required, except for AnalogItemType.
    std::optional<EUInformation> engineering_units;
    std::optional<Range> instrument_range;
    NodeId type{0, id::AnalogItemType};
};

/// Returns Bad_NodeAttributesInvalid for a DataType that is not a Number, for a range whose low
/// exceeds its high, and if a Property that `type` requires is missing.
BUSBAR_API Result<NodeIndex> add_analog_item(AddressSpace& space, const NewNode& node,
                                             const AnalogItem& item);

/// TwoStateDiscreteType (Part 8, 5.3.3.2): a Boolean.
struct TwoStateItem : DataItem {
    LocalizedText false_state;
    LocalizedText true_state;
};

/// Adds a TwoStateDiscreteType Variable (Part 8, 5.3.3.2).
BUSBAR_API Result<NodeIndex> add_two_state(AddressSpace& space, const NewNode& node,
                                           const TwoStateItem& item);

/// MultiStateDiscreteType (Part 8, 5.3.3.3): the value, an unsigned integer and UInt32 unless
/// `variable` says otherwise, is the index of a text.
struct MultiStateItem : DataItem {
    Array<LocalizedText> enum_strings;
};

/// Adds a MultiStateDiscreteType Variable (Part 8, 5.3.3.3).
BUSBAR_API Result<NodeIndex> add_multi_state(AddressSpace& space, const NewNode& node,
                                             const MultiStateItem& item);

/// MultiStateValueDiscreteType (Part 8, 5.3.3.4): values with gaps; Int32 unless `variable` says
/// otherwise. ValueAsText begins with the text of `variable.value`.
struct MultiStateValueItem : DataItem {
    Array<EnumValueType> enum_values;
};

/// Adds a MultiStateValueDiscreteType Variable (Part 8, 5.3.3.4).
BUSBAR_API Result<NodeIndex> add_multi_state_value(AddressSpace& space, const NewNode& node,
                                                   const MultiStateValueItem& item);

/// Sets the Variable's value, and its ValueAsText to the text that EnumValues has for it, or a null
/// text if there is none. Bad_TypeMismatch as AddressSpace::set_value; Bad_NotFound if the Variable
/// does not have the Properties.
BUSBAR_API Result<void> set_multi_state_value(AddressSpace& space, NodeIndex node, Variant value);

/// Returns Bad_OutOfRange for a value that a Variable of MultiStateDiscreteType has no EnumString
/// for, or one of MultiStateValueDiscreteType no EnumValue (Part 8, 5.3.3.3 and 5.3.3.4). Good for
/// any other Variable, and while the Property has no value.
[[nodiscard]] BUSBAR_API StatusCode check_state(const SpaceReader& space, NodeIndex variable,
                                                const Variant& value);
/// Sets ValueAsText to the text that EnumValues has for the Variable's present value, if it has
/// both.
BUSBAR_API void update_value_as_text(AddressSpace& space, NodeIndex variable);

/// The common properties of the ArrayItemTypes (Part 8, 5.3.4.2).
struct ArrayItem : DataItem {
    Range eu_range;
    EUInformation engineering_units;
    LocalizedText title;
    AxisScaleEnumeration axis_scale_type{};
    std::optional<Range> instrument_range;
    /// One axis for YArrayItemType and XYArrayItemType, two for ImageItemType, three for
    /// CubeItemType (x, y, z); for NDimensionArrayItemType any number, which is then the ValueRank.
    Array<AxisInformation> axes;
    /// Any concrete subtype of ArrayItemType in Part 8.
    NodeId type{0, id::YArrayItemType};
};

/// Adds an array item. The ValueRank follows from the type; the DataType of an XYArrayItemType is
/// XVType. Bad_NodeAttributesInvalid if the number of axes does not fit the type, or the low of a
/// range exceeds its high.
BUSBAR_API Result<NodeIndex> add_array_item(AddressSpace& space, const NewNode& node,
                                            const ArrayItem& item);

} // namespace busbar::model
