#include <busbar/backend/modbus_address.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "wire.hpp"

namespace busbar::backend {

namespace {

using busbar::detail::is_same_ignoring_case;

constexpr std::string_view modbus_places =
    "a table and an offset from 0, such as holding:0 (or coil, discrete, input), or a number of "
    "five or six digits, such as 40001";

struct ModbusTableRow {
    ModbusTable table;
    std::string_view name;
    /// First digit of its numbers.
    char digit;
};
constexpr std::array modbus_tables{
    ModbusTableRow{ModbusTable::Coil, "coil", '0'},
    ModbusTableRow{ModbusTable::DiscreteInput, "discrete", '1'},
    ModbusTableRow{ModbusTable::InputRegister, "input", '3'},
    ModbusTableRow{ModbusTable::HoldingRegister, "holding", '4'},
};

struct ModbusTypeName {
    ModbusType type;
    std::string_view name;
};
constexpr std::array modbus_types{
    ModbusTypeName{ModbusType::Bool, "bool"},     ModbusTypeName{ModbusType::Int16, "int16"},
    ModbusTypeName{ModbusType::UInt16, "uint16"}, ModbusTypeName{ModbusType::Int32, "int32"},
    ModbusTypeName{ModbusType::UInt32, "uint32"}, ModbusTypeName{ModbusType::Int64, "int64"},
    ModbusTypeName{ModbusType::UInt64, "uint64"}, ModbusTypeName{ModbusType::Float, "float"},
    ModbusTypeName{ModbusType::Double, "double"}, ModbusTypeName{ModbusType::Bcd16, "bcd16"},
    ModbusTypeName{ModbusType::Bcd32, "bcd32"},   ModbusTypeName{ModbusType::Bcd64, "bcd64"},
    ModbusTypeName{ModbusType::Text, "text"},
};
/// The longest text fits into one read; a write has two registers less.
constexpr unsigned max_modbus_text = 250;

/// An order by its name; `of_words` says whether it is for modbus_types of several registers.
struct ModbusOrderName {
    ModbusOrder order;
    std::string_view name;
    bool of_words;
};
constexpr std::array modbus_orders{
    ModbusOrderName{ModbusOrder::ABCD, "ABCD", true},
    ModbusOrderName{ModbusOrder::CDAB, "CDAB", true},
    ModbusOrderName{ModbusOrder::BADC, "BADC", true},
    ModbusOrderName{ModbusOrder::DCBA, "DCBA", true},
    ModbusOrderName{ModbusOrder::ABCD, "AB", false},
    ModbusOrderName{ModbusOrder::BADC, "BA", false},
};

/// True if the type's words have an order.
[[nodiscard]] bool has_words(const ModbusValueType& value)
{
    return value.type != ModbusType::Text && registers_of(value) > 1;
}

[[nodiscard]] bool is_decimal(std::string_view text)
{
    return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// The number that digits stand for; none if there are none, or it is more than `max`.
[[nodiscard]] std::optional<unsigned> decimal_of(std::string_view digits, unsigned max)
{
    unsigned number = 0;
    if (!is_decimal(digits) ||
        std::from_chars(digits.data(), digits.data() + digits.size(), number).ec != std::errc{} ||
        number > max) {
        return std::nullopt;
    }
    return number;
}

/// Reads an address from front to back, once.
class ModbusAddressReader {
public:
    explicit ModbusAddressReader(std::string_view text) : text_{text} {}

    [[nodiscard]] Configured<ModbusAddress> read()
    {
        if (!read_unit() || !read_place() || !read_bit() || !read_type() || !read_order() ||
            !is_within()) {
            return Unexpected<Problem>{std::move(problem_)};
        }
        return std::move(address_);
    }

private:
    [[nodiscard]] bool read_unit()
    {
        constexpr unsigned max_unit = 255;
        const std::size_t slash = text_.find('/');
        if (slash == std::string_view::npos) {
            return true;
        }
        const auto unit = decimal_of(text_.substr(0, slash), max_unit);
        if (!unit) {
            return fail(text_.substr(0, slash), "a unit id, which is 0 to 255, before '/'");
        }
        address_.unit = static_cast<std::uint8_t>(*unit);
        at_ = slash + 1;
        return true;
    }

    [[nodiscard]] bool read_place()
    {
        const std::string_view word = take_word(":.");
        if (is_decimal(word)) {
            return read_item(word);
        }
        const auto row = std::ranges::find_if(modbus_tables, [word](const ModbusTableRow& r) {
            return is_same_ignoring_case(r.name, word);
        });
        if (row == modbus_tables.end()) {
            return fail(word, modbus_places);
        }
        address_.table = row->table;
        if (!skip(':')) {
            return fail(rest(),
                        "':' and an offset from 0, such as " + std::string{row->name} + ":0");
        }
        const std::string_view digits = take_word(":.");
        const auto offset = decimal_of(digits, detail::end_of_modbus_items - 1);
        if (!offset) {
            return fail(digits, "an offset, which is 0 to 65535");
        }
        address_.offset = static_cast<std::uint16_t>(*offset);
        return true;
    }

    /// Reads a number such as 40001.
    [[nodiscard]] bool read_item(std::string_view digits)
    {
        constexpr std::size_t short_form = 5;
        constexpr unsigned last_of_short_form = 9999;
        if (digits.size() != short_form && digits.size() != short_form + 1) {
            return fail(digits, modbus_places);
        }
        const auto row = std::ranges::find(modbus_tables, digits[0], &ModbusTableRow::digit);
        if (row == modbus_tables.end()) {
            return fail(digits, "0, 1, 3 or 4 as first digit: coils, discrete inputs, input "
                                "registers, holding registers");
        }
        const auto item = decimal_of(digits.substr(1), detail::end_of_modbus_items);
        if (!item || *item == 0) {
            const unsigned last = digits.size() == short_form
                                      ? last_of_short_form
                                      : unsigned{detail::end_of_modbus_items};
            return fail(digits, "a table's digit and an item of 1 to " + std::to_string(last));
        }
        address_.table = row->table;
        address_.offset = static_cast<std::uint16_t>(*item - 1);
        return true;
    }

    [[nodiscard]] bool read_bit()
    {
        constexpr unsigned last_bit = 15;
        address_.value.type = has_bits(address_.table) ? ModbusType::Bool : ModbusType::UInt16;
        if (!skip('.')) {
            return true;
        }
        const std::string_view digits = take_word(":");
        if (has_bits(address_.table)) {
            return fail(digits, "no bit, since coils and discrete inputs are bits");
        }
        const auto bit = decimal_of(digits, last_bit);
        if (!bit) {
            return fail(digits, "a bit, which is 0 (the lowest) to 15");
        }
        address_.bit = static_cast<std::uint8_t>(*bit);
        address_.value.type = ModbusType::Bool;
        return true;
    }

    [[nodiscard]] bool read_type()
    {
        const std::size_t begin = at_;
        if (at_ == text_.size()) {
            return true;
        }
        if (!skip(':')) {
            return fail(rest(), "'.', ':' or the end");
        }
        const std::string_view word = take_word(":");
        if (order_of(word) != modbus_orders.end()) {
            at_ = begin;
            return true;
        }
        const std::string_view letters = word.substr(0, word.find_first_of("0123456789"));
        if (is_same_ignoring_case(letters, name_of(ModbusType::Text))) {
            return read_text_type(word, word.substr(letters.size()));
        }
        const auto type = std::ranges::find_if(modbus_types, [word](const ModbusTypeName& t) {
            return is_same_ignoring_case(t.name, word);
        });
        if (type == modbus_types.end()) {
            return fail(word, "a type (bool, int16, uint16, int32, uint32, int64, uint64, float, "
                              "double, bcd16, bcd32, bcd64, text20) or an order");
        }
        return accept_type(type->type, word);
    }

    [[nodiscard]] bool read_text_type(std::string_view word, std::string_view digits)
    {
        const auto length = decimal_of(digits, max_modbus_text);
        if (!length || *length == 0) {
            return fail(word, "the length of a text after its type, 1 to 250, such as text20");
        }
        address_.value.length = static_cast<std::uint8_t>(*length);
        return accept_type(ModbusType::Text, word);
    }

    [[nodiscard]] bool accept_type(ModbusType type, std::string_view word)
    {
        if (type != ModbusType::Bool && has_bits(address_.table)) {
            return fail(word, "bool, the only type of coils and discrete inputs");
        }
        if (type != ModbusType::Bool && address_.bit) {
            return fail(word, "bool, the only type of a bit");
        }
        address_.value.type = type;
        return true;
    }

    [[nodiscard]] bool read_order()
    {
        if (at_ == text_.size()) {
            return true;
        }
        if (!skip(':')) {
            return fail(rest(), "':' or the end");
        }
        const std::string_view word = take_word("");
        const auto order = order_of(word);
        if (address_.value.type == ModbusType::Bool) {
            return fail(word, "the end, since a bool has no order");
        }
        const bool words = has_words(address_.value);
        if (order == modbus_orders.end() || order->of_words != words) {
            return fail(word, words ? "an order: ABCD, CDAB, BADC or DCBA"
                                    : "an order of two bytes: AB or BA");
        }
        address_.value.order = order->order;
        return true;
    }

    [[nodiscard]] bool is_within()
    {
        const std::size_t count = has_bits(address_.table) ? 1 : registers_of(address_.value);
        at_ = 0;
        return address_.offset + count <= detail::end_of_modbus_items ||
               fail(text_, "a value that ends with register 65535, from 0, at the latest");
    }

    [[nodiscard]] static decltype(modbus_orders)::const_iterator order_of(std::string_view word)
    {
        return std::ranges::find_if(modbus_orders, [word](const ModbusOrderName& o) {
            return is_same_ignoring_case(o.name, word);
        });
    }

    [[nodiscard]] static std::string_view name_of(ModbusType type)
    {
        return std::ranges::find(modbus_types, type, &ModbusTypeName::type)->name;
    }

    [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

    /// Takes what is before the next of `ends`.
    [[nodiscard]] std::string_view take_word(std::string_view ends)
    {
        const std::size_t end = std::min(text_.find_first_of(ends, at_), text_.size());
        const std::string_view word = text_.substr(at_, end - at_);
        at_ = end;
        return word;
    }

    [[nodiscard]] bool skip(char c)
    {
        const bool is_there = at_ < text_.size() && text_[at_] == c;
        at_ += is_there ? 1 : 0;
        return is_there;
    }

    /// Reports `word`, which is a part of the text; always returns false.
    bool fail(std::string_view word, std::string_view expected)
    {
        constexpr std::size_t enough = 40;
        problem_.where =
            "column " + std::to_string(static_cast<std::size_t>(word.data() - text_.data()) + 1);
        problem_.text = "found " +
                        (word.empty() ? at_ == text_.size() ? std::string{"the end"}
                                                            : "'" + std::string{text_[at_]} + "'"
                                      : "'" + printable(word.substr(0, enough), enough) + "'") +
                        ", expected " + std::string{expected};
        return false;
    }

    std::string_view text_;
    std::size_t at_{0};
    ModbusAddress address_{};
    Problem problem_{};
};

} // namespace

Configured<ModbusAddress> parse_modbus_address(std::string_view text)
{
    return ModbusAddressReader{text}.read();
}

std::string to_text(const ModbusAddress& address)
{
    const ModbusValueType& value = address.value;
    std::string text = address.unit ? std::to_string(*address.unit) + "/" : "";
    text += std::ranges::find(modbus_tables, address.table, &ModbusTableRow::table)->name;
    text += ":" + std::to_string(address.offset);
    if (address.bit) {
        return text + "." + std::to_string(*address.bit);
    }
    const auto usual = has_bits(address.table) ? ModbusType::Bool : ModbusType::UInt16;
    if (value.type != usual) {
        text += ":";
        text += std::ranges::find(modbus_types, value.type, &ModbusTypeName::type)->name;
        text += value.type == ModbusType::Text ? std::to_string(value.length) : "";
    }
    if (value.order != ModbusOrder::ABCD) {
        const auto order = std::ranges::find_if(modbus_orders, [&](const ModbusOrderName& o) {
            return o.order == value.order && o.of_words == has_words(value);
        });
        text += order == modbus_orders.end() ? "" : ":" + std::string{order->name};
    }
    return text;
}

} // namespace busbar::backend
