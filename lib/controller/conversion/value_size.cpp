#include <algorithm>
#include <array>

#include <busbar/controller/value_shape.hpp>

namespace busbar::controller {

namespace {

/// The size that a text of any length counts as (2.1, note 4).
constexpr std::size_t text_words = 256;

/// Sizes by BuiltInType (8.1, CreateMonitoredItems).
constexpr std::array<std::uint16_t, last_built_in_type + 1> monitored{
    0,     // Null
    1,     // Boolean
    1,     // SByte
    1,     // Byte
    2,     // Int16
    2,     // UInt16
    4,     // Int32
    4,     // UInt32
    8,     // Int64
    8,     // UInt64
    4,     // Float
    8,     // Double
    1024,  // String
    8,     // DateTime
    1,     // Guid
    10240, // ByteString
    1,     // XmlElement
    1,     // NodeId
    1,     // ExpandedNodeId
    1,     // StatusCode
    1,     // QualifiedName
    1024,  // LocalizedText
    1,     // ExtensionObject
    1,     // DataValue
    1,     // Variant
    1,     // DiagnosticInfo
};

} // namespace

std::size_t words_of(LeafType leaf)
{
    std::size_t most = 0;
    for (auto type = backend::LabelType::Bit; type <= backend::LabelType::UnicodeString;
         type = static_cast<backend::LabelType>(static_cast<int>(type) + 1)) {
        if (assignability(leaf, type, backend::TimerPart::None) != Assignability::No) {
            const std::size_t words =
                backend::is_text(type) ? text_words : backend::words_of({type});
            most = std::max(most, words);
        }
    }
    return most;
}

std::size_t monitored_bytes_of(BuiltInType type)
{
    return monitored[static_cast<std::size_t>(type)];
}

} // namespace busbar::controller
