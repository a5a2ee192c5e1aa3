#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include <busbar/binary/codec.hpp>
#include <busbar/core/data_value.hpp>

/// The encoding of a DataValue (Part 6, 5.2.2.17), shared by code that decodes it, code that only
/// checks it, and code that writes one whose parts are in several places.
namespace busbar::detail {

namespace data_value_mask {
template <unsigned mask>
using Bit = std::integral_constant<unsigned, mask>;

using Value = Bit<0x01>;
using Status = Bit<0x02>;
using SourceTimestamp = Bit<0x04>;
using ServerTimestamp = Bit<0x08>;
using SourcePicoseconds = Bit<0x10>;
using ServerPicoseconds = Bit<0x20>;
inline constexpr unsigned all = 0x3F;
} // namespace data_value_mask

inline constexpr std::uint16_t max_picoseconds = 9'999;

/// Calls `visit` with the Bit of each field in the mask, in the order of the fields.
template <typename Visit>
void visit_data_value(unsigned mask, Visit visit)
{
    const auto visit_if = [&](auto bit) {
        if ((mask & bit) != 0) {
            visit(bit);
        }
    };
    visit_if(data_value_mask::Value{});
    visit_if(data_value_mask::Status{});
    visit_if(data_value_mask::SourceTimestamp{});
    visit_if(data_value_mask::SourcePicoseconds{});
    visit_if(data_value_mask::ServerTimestamp{});
    visit_if(data_value_mask::ServerPicoseconds{});
}

/// Reads the mask and lets `visit` read each field that follows. Bad_DecodingError if an unused bit
/// is set.
template <typename Visit>
void read_data_value(binary::Reader& reader, Visit visit)
{
    const unsigned mask = reader.number<std::uint8_t>();
    if ((mask & ~data_value_mask::all) != 0) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    visit_data_value(mask, visit);
}

/// The parts to be written as a DataValue. A field that is null, Good or zero is left out.
struct DataValueParts {
    const Variant* value{nullptr};
    StatusCode status;
    DateTime source_timestamp;
    std::uint16_t source_picoseconds{0};
    DateTime server_timestamp;
    std::uint16_t server_picoseconds{0};

    [[nodiscard]] unsigned mask() const
    {
        namespace bits = data_value_mask;
        const auto bit_if = [](bool is_there, unsigned bit) { return is_there ? bit : 0U; };
        return bit_if(value != nullptr && !value->is_null(), bits::Value{}) |
               bit_if(status != StatusCode{}, bits::Status{}) |
               bit_if(!source_timestamp.is_null(), bits::SourceTimestamp{}) |
               bit_if(!server_timestamp.is_null(), bits::ServerTimestamp{}) |
               bit_if(source_picoseconds != 0, bits::SourcePicoseconds{}) |
               bit_if(server_picoseconds != 0, bits::ServerPicoseconds{});
    }
};

/// Static, so that it is inlined into its one caller in a file.
static inline void write_data_value(binary::Writer& writer, const DataValueParts& parts)
{
    namespace bits = data_value_mask;
    const unsigned mask = parts.mask();
    writer.number(static_cast<std::uint8_t>(mask));
    visit_data_value(mask, [&](auto bit) {
        using Bit = decltype(bit);
        if constexpr (std::is_same_v<Bit, bits::Value>) {
            encode(writer, *parts.value);
        } else if constexpr (std::is_same_v<Bit, bits::Status>) {
            encode(writer, parts.status);
        } else if constexpr (std::is_same_v<Bit, bits::SourceTimestamp>) {
            encode(writer, parts.source_timestamp);
        } else if constexpr (std::is_same_v<Bit, bits::SourcePicoseconds>) {
            writer.number(std::min(parts.source_picoseconds, max_picoseconds));
        } else if constexpr (std::is_same_v<Bit, bits::ServerTimestamp>) {
            encode(writer, parts.server_timestamp);
        } else {
            writer.number(std::min(parts.server_picoseconds, max_picoseconds));
        }
    });
}

} // namespace busbar::detail
