#include <busbar/binary/codec.hpp>

#include "wire_masks.hpp"

namespace busbar {

namespace {

namespace info_bits = detail::diagnostic_info_mask;

unsigned mask_of(const DiagnosticInfo& value)
{
    return (value.symbolic_id ? info_bits::symbolic_id : 0U) |
           (value.namespace_uri ? info_bits::namespace_uri : 0U) |
           (value.localized_text ? info_bits::localized_text : 0U) |
           (value.locale ? info_bits::locale : 0U) |
           (value.additional_info ? info_bits::additional_info : 0U) |
           (value.inner_status_code ? info_bits::inner_status_code : 0U) |
           (value.inner_diagnostic_info ? info_bits::inner_diagnostic_info : 0U);
}

template <typename T>
void encode_if(binary::Writer& writer, const std::optional<T>& field)
{
    if (field) {
        encode(writer, *field);
    }
}

template <typename T>
void decode_if(binary::Reader& reader, bool is_present, std::optional<T>& field)
{
    field.reset();
    if (is_present) {
        decode(reader, field.emplace());
    }
}

void decode_inner(binary::Reader& reader, std::unique_ptr<DiagnosticInfo>& inner)
{
    if (!reader.charge(sizeof(DiagnosticInfo))) {
        return;
    }
    inner = std::make_unique<DiagnosticInfo>();
    decode(reader, *inner);
}

} // namespace

void encode(binary::Writer& writer, const DiagnosticInfo& value)
{
    if (!writer.enter()) {
        return;
    }
    writer.number(static_cast<std::uint8_t>(mask_of(value)));
    encode_if(writer, value.symbolic_id);
    encode_if(writer, value.namespace_uri);
    encode_if(writer, value.locale);
    encode_if(writer, value.localized_text);
    encode_if(writer, value.additional_info);
    encode_if(writer, value.inner_status_code);
    if (value.inner_diagnostic_info) {
        encode(writer, *value.inner_diagnostic_info);
    }
    writer.leave();
}

void decode(binary::Reader& reader, DiagnosticInfo& value)
{
    const unsigned mask = reader.number<std::uint8_t>();
    if ((mask & info_bits::reserved) != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.enter_diagnostic()) {
        return;
    }
    decode_if(reader, (mask & info_bits::symbolic_id) != 0, value.symbolic_id);
    decode_if(reader, (mask & info_bits::namespace_uri) != 0, value.namespace_uri);
    decode_if(reader, (mask & info_bits::locale) != 0, value.locale);
    decode_if(reader, (mask & info_bits::localized_text) != 0, value.localized_text);
    decode_if(reader, (mask & info_bits::additional_info) != 0, value.additional_info);
    decode_if(reader, (mask & info_bits::inner_status_code) != 0, value.inner_status_code);
    value.inner_diagnostic_info.reset();
    if ((mask & info_bits::inner_diagnostic_info) != 0 && reader.ok()) {
        decode_inner(reader, value.inner_diagnostic_info);
    }
    reader.leave_diagnostic();
}

} // namespace busbar
