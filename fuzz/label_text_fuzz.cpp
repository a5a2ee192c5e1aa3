#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/label_conversion.hpp>
#include <busbar/core/types.hpp>

#include "fuzz_script.hpp"

namespace label_text_fuzz {

using namespace busbar;
using backend::LabelType;
using controller::LabelConversion;

namespace {

void check(bool condition)
{
    if (!condition) {
        std::abort();
    }
}

LabelConversion conversion_of(LabelType type, std::uint32_t length)
{
    return *LabelConversion::of({BuiltInType::String, false},
                                {type, backend::TimerPart::None, length});
}

/// A label of its own, so that a sanitizer sees what lies behind it.
using Label = std::vector<std::byte>;

String read(const LabelConversion& conversion, const Label& label)
{
    String text;
    check(conversion.read(label.data(), &text).is_good());
    return text;
}

StatusCode write(const LabelConversion& conversion, std::string_view text, Label& label)
{
    label.assign(conversion.label_size(), std::byte{0xEE});
    return conversion.write(String{text}, std::span<std::byte>{label});
}

/// Any bytes of a label give a text that can be written and, once written, stays as it is.
void check_label(const LabelConversion& conversion, std::span<const std::byte> bytes)
{
    Label label(bytes.begin(), bytes.end());
    label.resize(conversion.label_size());
    const String text = read(conversion, label);
    Label written;
    check(write(conversion, text.view(), written).is_good());
    const String again = read(conversion, written);
    Label third;
    check(write(conversion, again.view(), third).is_good());
    check(third == written);
}

/// What is cut off is the end of what a longer label has.
void check_text(LabelType type, std::uint32_t length, std::string_view text)
{
    const LabelConversion narrow = conversion_of(type, length);
    const LabelConversion wide = conversion_of(type, 4 * 256);
    Label short_label;
    Label long_label;
    const StatusCode status = write(narrow, text, short_label);
    check(status == write(wide, text, long_label));
    if (status.is_bad()) {
        check(status == status::Bad_OutOfRange);
        return;
    }
    const String all = read(wide, long_label);
    const String some = read(narrow, short_label);
    check(all.view().starts_with(some.view()));
    check(short_label.back() == std::byte{0});
}

} // namespace

/// Bytes of a label to text, and text to labels that may be too short for it.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const LabelType type = script.byte() % 2U == 0 ? LabelType::String : LabelType::UnicodeString;
    const std::uint32_t length = script.byte();
    const auto bytes = script.bytes(256);
    check_label(conversion_of(type, length), bytes);
    check_text(type, length, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return 0;
}

} // namespace label_text_fuzz
