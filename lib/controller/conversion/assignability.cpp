#include <array>
#include <string_view>

#include <busbar/controller/label_conversion.hpp>

namespace busbar::controller {

namespace {

using backend::LabelType;
using backend::TimerPart;

// Columns are the label types up to UnicodeString: Bit, UnsignedWord, UnsignedDoubleWord, Word,
// DoubleWord, Float, Double, Time, String, UnicodeString. '=' is Same, 'o' Checked.
constexpr std::string_view no_label = "----------";

constexpr std::array<std::string_view, last_built_in_type + 1> rows{
    no_label,     // Null
    "=---------", // Boolean
    "-oooo-----", // SByte
    "-oooo-----", // Byte
    "-oo=o-----", // Int16
    "-=ooo-----", // UInt16
    "-ooo=--=--", // Int32
    "-o=oo-----", // UInt32
    "-oooo-----", // Int64
    "-oooo-----", // UInt64
    "-----=o---", // Float
    "-----o=---", // Double
    "--------oo", // String
    "--o-o-----", // DateTime
    no_label,     // Guid
    no_label,     // ByteString
    no_label,     // XmlElement
    no_label,     // NodeId
    no_label,     // ExpandedNodeId
    no_label,     // StatusCode
    no_label,     // QualifiedName
    "--------oo", // LocalizedText
    no_label,     // ExtensionObject
    no_label,     // DataValue
    no_label,     // Variant
    no_label,     // DiagnosticInfo
};
constexpr std::string_view enumeration_row = "-ooo=-----";

bool is_timer_or_counter(LabelType type)
{
    return type >= LabelType::Timer && type <= LabelType::LongCounter;
}

} // namespace

Assignability assignability(LeafType leaf, LabelType type, TimerPart part)
{
    const bool is_timer = is_timer_or_counter(type);
    if (is_timer != (part != TimerPart::None) || (is_timer && leaf.is_enumeration)) {
        return Assignability::No;
    }
    // Timers and counters use the columns of the types of their parts.
    const auto column = static_cast<std::size_t>(backend::value_type(type, part));
    const std::string_view row =
        leaf.is_enumeration ? enumeration_row : rows[static_cast<std::size_t>(leaf.built_in)];
    if (column >= row.size() || row[column] == '-') {
        return Assignability::No;
    }
    return row[column] == '=' ? Assignability::Same : Assignability::Checked;
}

} // namespace busbar::controller
