#include "layout.hpp"

#include <algorithm>

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t mask_bits = 32; // Part 6, 5.2.7

bool is_schema_type(const RawField& field, std::string_view name)
{
    return field.type.namespace_uri == binary_schema_uri && field.type.name == name;
}

bool is_bit(const RawField& field)
{
    return is_schema_type(field, "Bit");
}

/// True for a type that may count the elements of an array, or select the alternative of a union.
bool is_number_of_32_bits(const RawField& field)
{
    return (is_schema_type(field, "Int32") || is_schema_type(field, "UInt32")) && !field.length &&
           field.length_field.empty();
}

bool is_length_of(const RawField& field, const RawField& next)
{
    return is_number_of_32_bits(field) && next.length_field == field.name &&
           next.switch_field == field.switch_field && next.switch_value == field.switch_value;
}

/// Walks through the fields once; the first one that does not fit determines the reason.
class Layout {
public:
    Layout(const std::vector<RawField>& from, DictionaryType& type) : from_{from}, type_{type} {}

    void run(bool says_union)
    {
        const bool is_union = says_union || looks_like_union();
        type_.kind = is_union ? DictionaryType::Kind::Union : DictionaryType::Kind::Structure;
        if (is_union) {
            skip_switch();
        } else {
            read_mask();
        }
        while (at_ < from_.size() && type_.reason.empty()) {
            take_field();
        }
        if (!type_.reason.empty()) {
            type_.fields.clear();
        }
    }

private:
    void fail(const RawField& field, const std::string& reason)
    {
        type_.reason = "field " + field.name + ": " + reason;
    }

    /// True for a number followed by nothing but fields that depend on its value.
    [[nodiscard]] bool looks_like_union() const
    {
        return from_.size() > 1 && is_number_of_32_bits(from_[0]) &&
               from_[0].switch_field.empty() &&
               std::all_of(from_.begin() + 1, from_.end(), [&](const RawField& field) {
                   return field.switch_field == from_[0].name && field.switch_value.has_value();
               });
    }
    /// Skips the switch, so that the alternatives begin with the second field.
    void skip_switch()
    {
        if (from_.empty() || !is_number_of_32_bits(from_[0])) {
            type_.reason = "a Union has to begin with a UInt32";
        }
        at_ = 1;
    }
    void read_mask()
    {
        std::uint32_t bits = 0;
        for (; at_ < from_.size() && is_bit(from_[at_]); ++at_) {
            const std::uint32_t length = from_[at_].length.value_or(1);
            if (length == 0 || length > mask_bits - bits) {
                return fail(from_[at_], "an EncodingMask has 32 bits");
            }
            if (length == 1) {
                switches_.push_back({from_[at_].name, bits});
            }
            bits += length;
        }
        type_.has_mask = bits != 0;
        if (bits != 0 && bits != mask_bits) {
            fail(from_[at_ - 1], "bits are there, and they are not the 32 of an EncodingMask");
        }
    }

    void take_field()
    {
        const bool has_length = at_ + 1 < from_.size() && is_length_of(from_[at_], from_[at_ + 1]);
        const RawField& field = from_[has_length ? at_ + 1 : at_];
        at_ += has_length ? 2 : 1;
        DictionaryField to{field.name, field.type, has_length, false};
        if (!check(field, has_length)) {
            return;
        }
        if (is_schema_type(field, "Char") && has_length) {
            to.type.name = "CharArray";
            to.is_array = false;
        }
        if (type_.kind == DictionaryType::Kind::Union) {
            check_alternative(field);
        } else if (!field.switch_field.empty()) {
            check_switch(field);
            to.is_optional = true;
        }
        type_.fields.push_back(std::move(to));
    }
    [[nodiscard]] bool check(const RawField& field, bool has_length)
    {
        if (is_bit(field)) {
            fail(field, "single bits follow other fields");
        } else if (field.length) {
            fail(field, "its length is fixed");
        } else if (!has_length && !field.length_field.empty()) {
            fail(field, "its length " + field.length_field + " is not an Int32 directly before it");
        } else if (field.has_terminator) {
            fail(field, "its end is marked by a Terminator");
        } else if (field.has_operand) {
            fail(field, "its SwitchOperand is not Equals");
        } else if (field.is_length_in_bytes && !is_schema_type(field, "Byte") &&
                   !is_schema_type(field, "Char")) {
            fail(field, "its length counts bytes");
        }
        return type_.reason.empty();
    }
    /// The alternatives are numbered from one (Part 6, 5.2.8).
    void check_alternative(const RawField& field)
    {
        if (field.switch_field != from_[0].name || field.switch_value != type_.fields.size() + 1) {
            fail(field, "expected SwitchField " + from_[0].name + " and SwitchValue " +
                            std::to_string(type_.fields.size() + 1));
        }
    }
    /// The bits are those of the optional fields, in their order (Part 6, 5.2.7).
    void check_switch(const RawField& field)
    {
        const auto found =
            std::find_if(switches_.begin(), switches_.end(),
                         [&](const Switch& each) { return each.name == field.switch_field; });
        if (found == switches_.end() || field.switch_value.value_or(1) != 1) {
            fail(field,
                 "its SwitchField " + field.switch_field + " is not a bit of an EncodingMask");
        } else if (found->bit != optional_fields_++) {
            fail(field, "its bit is not that of the optional field number " +
                            std::to_string(optional_fields_));
        }
    }

    struct Switch {
        std::string name;
        std::uint32_t bit;
    };

    const std::vector<RawField>& from_;
    DictionaryType& type_;
    std::vector<Switch> switches_;
    std::uint32_t optional_fields_{0};
    std::size_t at_{0};
};

} // namespace

void lay_out(const std::vector<RawField>& fields, bool says_union, DictionaryType& type)
{
    Layout{fields, type}.run(says_union);
}

} // namespace busbar::client::detail
