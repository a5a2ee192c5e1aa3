#include <busbar/binary/codec.hpp>

namespace busbar {

namespace {

// Part 6, 5.2.2.12
constexpr unsigned symbolic_id_bit = 0x01;
constexpr unsigned namespace_uri_bit = 0x02;
constexpr unsigned localized_text_bit = 0x04;
constexpr unsigned locale_bit = 0x08;
constexpr unsigned additional_info_bit = 0x10;
constexpr unsigned inner_status_code_bit = 0x20;
constexpr unsigned inner_diagnostic_info_bit = 0x40;
constexpr unsigned reserved_bit = 0x80;

unsigned mask_of(const DiagnosticInfo& value)
{
    return (value.symbolic_id ? symbolic_id_bit : 0U) |
           (value.namespace_uri ? namespace_uri_bit : 0U) |
           (value.localized_text ? localized_text_bit : 0U) | (value.locale ? locale_bit : 0U) |
           (value.additional_info ? additional_info_bit : 0U) |
           (value.inner_status_code ? inner_status_code_bit : 0U) |
           (value.inner_diagnostic_info ? inner_diagnostic_info_bit : 0U);
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
    if ((mask & reserved_bit) != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.enter_diagnostic()) {
        return;
    }
    decode_if(reader, (mask & symbolic_id_bit) != 0, value.symbolic_id);
    decode_if(reader, (mask & namespace_uri_bit) != 0, value.namespace_uri);
    decode_if(reader, (mask & locale_bit) != 0, value.locale);
    decode_if(reader, (mask & localized_text_bit) != 0, value.localized_text);
    decode_if(reader, (mask & additional_info_bit) != 0, value.additional_info);
    decode_if(reader, (mask & inner_status_code_bit) != 0, value.inner_status_code);
    value.inner_diagnostic_info.reset();
    if ((mask & inner_diagnostic_info_bit) != 0 && reader.ok()) {
        decode_inner(reader, value.inner_diagnostic_info);
    }
    reader.leave_diagnostic();
}

} // namespace busbar
