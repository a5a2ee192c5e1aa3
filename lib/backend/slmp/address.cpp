#include <busbar/backend/slmp_device.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"

namespace busbar::backend {

namespace {

constexpr std::uint32_t max_short_number = 0xFFFFFF;
constexpr std::uint8_t module_memory = 0xF8;
constexpr std::uint8_t link_memory = 0xF9;
constexpr std::uint8_t cpu_memory = 0xFA;
/// U3E0 to U3E3 are the CPUs of a rack.
constexpr std::uint32_t first_cpu = 0x3E0;
constexpr std::uint32_t last_cpu = 0x3E3;
constexpr std::uint32_t last_network = 255;

int base_of(const SlmpDeviceType& type, const SlmpNotation& notation)
{
    if (notation.is_octal && (type.name == "X" || type.name == "Y")) {
        return 8;
    }
    return type.is_hexadecimal || (notation.is_zr_hexadecimal && type.name == "ZR") ? 16 : 10;
}

std::string_view name_of_base(int base)
{
    return base == 8 ? "octal" : base == 10 ? "decimal" : "hexadecimal";
}

bool is_in_links(const SlmpDeviceType& type)
{
    constexpr std::array<std::string_view, 6> names{"X", "Y", "B", "W", "SB", "SW"};
    return std::find(names.begin(), names.end(), type.name) != names.end();
}

bool begins_with(std::string_view text, std::string_view name)
{
    return text.size() >= name.size() &&
           busbar::detail::is_same_ignoring_case(text.substr(0, name.size()), name);
}

std::string to_digits(std::uint32_t number, int base)
{
    std::array<char, 12> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number, base).ptr;
    std::string text{digits.data(), end};
    std::ranges::transform(text, text.begin(), [](char c) {
        return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    return text;
}

/// Reads an address from front to back, once.
class AddressReader {
public:
    AddressReader(std::string_view text, const SlmpNotation& notation)
        : text_{text}, notation_{notation}
    {
    }

    [[nodiscard]] Configured<SlmpAddress> read()
    {
        if (!read_place() || !read_type() || !read_number() || !read_bit()) {
            return Unexpected<Problem>{std::move(problem_)};
        }
        if (at_ != text_.size()) {
            fail("the end");
            return Unexpected<Problem>{std::move(problem_)};
        }
        return address_;
    }

private:
    /// "U01\" or "J1\", which most addresses do not have.
    [[nodiscard]] bool read_place()
    {
        if (text_.find('\\') == std::string_view::npos) {
            return true;
        }
        const bool is_module = begins_with(text_, "U");
        if (!is_module && !begins_with(text_, "J")) {
            return fail("U and the number of a module, or J and that of a network, before \\");
        }
        at_ = 1;
        std::uint32_t number = 0;
        if (!read_digits(number, is_module ? 16 : 10, is_module ? "a module" : "a network")) {
            return false;
        }
        const bool is_cpu = number >= first_cpu && number <= last_cpu;
        if (is_module ? number > last_cpu || (number > 0xFF && !is_cpu)
                      : number == 0 || number > last_network) {
            at_ = 1;
            return fail(is_module ? "a module, U0 to UFF, or a CPU, U3E0 to U3E3"
                                  : "a network, J1 to J255");
        }
        if (at_ == text_.size() || text_[at_] != '\\') {
            return fail("\\ and a device");
        }
        ++at_;
        address_.device.extension = static_cast<std::uint16_t>(number);
        address_.device.direct_memory = !is_module ? link_memory
                                        : is_cpu   ? cpu_memory
                                                   : module_memory;
        return true;
    }

    [[nodiscard]] bool read_type()
    {
        const std::string_view rest = text_.substr(at_);
        for (const SlmpDeviceType& type : slmp_device_types()) {
            if (begins_with(rest, type.name) &&
                (type_ == nullptr || type.name.size() > type_->name.size())) {
                type_ = &type;
            }
        }
        if (type_ == nullptr) {
            return fail("a device, such as D, W, R, M, X or Y");
        }
        if (!type_->has_short_form && !notation_.has_long_form) {
            return fail("a device that a PLC before iQ-R has");
        }
        const std::uint8_t place = address_.device.direct_memory;
        if (place == link_memory ? !is_in_links(*type_) : type_->is_in_module != (place != 0)) {
            return fail(place == 0             ? "U and the number of a module, as in U01\\G22"
                        : place == link_memory ? "a link device: X, Y, B, W, SB or SW"
                                               : "G or HG, which are what a module has");
        }
        if (type_->name == "HG" && place != cpu_memory) {
            return fail("G, since only a CPU, U3E0 to U3E3, has HG");
        }
        at_ += type_->name.size();
        address_.device.code = type_->code;
        return true;
    }

    [[nodiscard]] bool read_number()
    {
        const std::size_t begin = at_;
        std::uint32_t number = 0;
        if (!read_digits(number, base_of(*type_, notation_), type_->name)) {
            return false;
        }
        if (!notation_.has_long_form && number > max_short_number) {
            at_ = begin;
            return fail("a number of up to " +
                        to_digits(max_short_number, base_of(*type_, notation_)));
        }
        address_.device.number = number;
        return true;
    }

    [[nodiscard]] bool read_bit()
    {
        if (at_ == text_.size() || text_[at_] != '.') {
            return true;
        }
        if (type_->unit != SlmpUnit::Word) {
            return fail("the end: only words have bits, and " + std::string{type_->name} + " has " +
                        (type_->unit == SlmpUnit::Bit ? "none" : "more than one word"));
        }
        const std::string_view rest = text_.substr(at_ + 1);
        std::uint8_t bit = 0;
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), bit, 16);
        if (error != std::errc{} || end != rest.data() + rest.size() || rest.size() != 1) {
            ++at_;
            return fail("a bit, which is one hexadecimal digit, 0 to F");
        }
        at_ = text_.size();
        address_.bit = bit;
        return true;
    }

    /// Reads the number of `whom`.
    [[nodiscard]] bool read_digits(std::uint32_t& number, int base, std::string_view whom)
    {
        const char* const begin = text_.data() + at_;
        const char* const last = text_.data() + text_.size();
        const auto [end, error] = std::from_chars(begin, last, number, base);
        const auto is_alphanumeric = [](char c) {
            return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
        };
        if (error == std::errc::result_out_of_range) {
            return fail("a number of up to " + to_digits(UINT32_MAX, base));
        }
        if (error != std::errc{} || (end != last && is_alphanumeric(*end))) {
            at_ += error == std::errc{} ? static_cast<std::size_t>(end - begin) : 0;
            return fail(std::string{name_of_base(base)} + " digits, since the numbers of " +
                        std::string{whom} + " are " + std::string{name_of_base(base)});
        }
        at_ += static_cast<std::size_t>(end - begin);
        return true;
    }

    /// Reports a problem; always returns false.
    bool fail(std::string_view expected)
    {
        constexpr std::size_t enough = 40;
        const std::string_view rest = text_.substr(at_);
        const std::string found =
            rest.empty() ? "the end" : "'" + printable(rest.substr(0, enough), enough) + "'";
        problem_.where = "column " + std::to_string(at_ + 1);
        problem_.text = "found " + found + ", expected " + std::string{expected};
        return false;
    }

    std::string_view text_;
    SlmpNotation notation_;
    std::size_t at_{0};
    const SlmpDeviceType* type_{nullptr};
    SlmpAddress address_{};
    Problem problem_{};
};

} // namespace

Configured<SlmpAddress> parse_slmp_address(std::string_view text, const SlmpNotation& notation)
{
    return AddressReader{text, notation}.read();
}

std::string to_text(const SlmpAddress& address, const SlmpNotation& notation)
{
    const SlmpDevice& device = address.device;
    std::string text;
    if (device.direct_memory == link_memory) {
        text = "J" + to_digits(device.extension, 10) + "\\";
    } else if (device.direct_memory != 0) {
        text = "U" + to_digits(device.extension, 16) + "\\";
    }
    const SlmpDeviceType* const type = find_slmp_device_type(device.code);
    if (type == nullptr) {
        text += "?" + to_digits(device.code, 16) + ":" + to_digits(device.number, 10);
    } else {
        text += std::string{type->name} + to_digits(device.number, base_of(*type, notation));
    }
    if (address.bit) {
        text += "." + to_digits(*address.bit, 16);
    }
    return text;
}

} // namespace busbar::backend
