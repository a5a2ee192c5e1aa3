#include <busbar/backend/label_name.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "core/utf8.hpp"

namespace busbar::backend {

namespace {

constexpr std::size_t max_dimensions = 3;

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/// True for a character that separates names.
bool is_delimiter(char c)
{
    return c == '.' || c == ',' || c == '[' || c == ']';
}

/// Counts UTF-8 characters; each invalid byte counts as one.
std::size_t characters(std::string_view text)
{
    std::size_t count = 0;
    for (; !text.empty(); ++count) {
        text.remove_prefix(std::max<std::size_t>(1, busbar::detail::utf8_sequence(text)));
    }
    return count;
}

/// True for digits of a bit device's word: K, the number of digits and the name (SH-082679, 8.3).
bool is_digit_specification(std::string_view name)
{
    constexpr std::size_t prefix = 2;
    return name.size() > prefix && busbar::detail::to_ascii_lower(name[0]) == 'k' &&
           name[1] >= '1' && name[1] <= '8' && !is_digit(name[prefix]);
}

/// Reads a name from front to back, once.
class NameReader {
public:
    explicit NameReader(std::string_view text) : text_{text} {}

    [[nodiscard]] Configured<LabelName> read()
    {
        LabelName name;
        do {
            LabelName::Part part;
            if (!read_name(part, name.parts.empty()) || !read_indices(part)) {
                return Unexpected<Problem>{std::move(problem_)};
            }
            name.parts.push_back(std::move(part));
        } while (skip('.'));
        if (at_ != text_.size()) {
            fail(name.parts.back().indices.empty() ? "'.', '[' or the end" : "'.' or the end");
            return Unexpected<Problem>{std::move(problem_)};
        }
        return name;
    }

private:
    [[nodiscard]] bool read_name(LabelName::Part& part, bool is_first)
    {
        const std::size_t begin = at_;
        if (at_ < text_.size() && is_digit(text_[at_])) {
            return fail(is_first ? "a name, which does not begin with a digit"
                                 : "a member's name: bits of labels cannot be mapped");
        }
        while (at_ < text_.size() && !is_delimiter(text_[at_])) {
            if (!take_character()) {
                return false;
            }
        }
        if (at_ == begin) {
            return fail(is_first ? "a label's name" : "a member's name");
        }
        part.name = text_.substr(begin, at_ - begin);
        if (is_first && is_digit_specification(part.name)) {
            at_ = begin;
            return fail("a label's name: digits of labels cannot be mapped");
        }
        return count_in(characters(part.name) + (is_first ? 0 : 1));
    }

    [[nodiscard]] bool take_character()
    {
        const std::size_t length = busbar::detail::utf8_sequence(text_.substr(at_));
        const auto lead = static_cast<unsigned char>(text_[at_]);
        if (length == 0 || lead < 0x20U || lead == 0x7FU) {
            return fail("a UTF-8 character that is not a control character");
        }
        at_ += length;
        return true;
    }

    /// Reads any number of indices, such as "[1,2]" and "[1][2]".
    [[nodiscard]] bool read_indices(LabelName::Part& part)
    {
        while (skip('[')) {
            do {
                if (!read_index(part)) {
                    return false;
                }
            } while (skip(','));
            if (!skip(']')) {
                return fail("',' or ']'");
            }
        }
        // "[1,2]" counts a character for each index and one for the end.
        return count_in(part.indices.empty() ? 0 : part.indices.size() + 1);
    }

    [[nodiscard]] bool read_index(LabelName::Part& part)
    {
        if (part.indices.size() == max_dimensions) {
            return fail("at most three indices");
        }
        std::uint32_t index = 0;
        const char* const begin = text_.data() + at_;
        const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), index);
        if (error != std::errc{}) {
            return fail("an index, which is a decimal number of up to 4294967295");
        }
        at_ += static_cast<std::size_t>(end - begin);
        part.indices.push_back(index);
        return count_in(std::to_string(index).size());
    }

    [[nodiscard]] bool skip(char c)
    {
        const bool is_there = at_ < text_.size() && text_[at_] == c;
        at_ += is_there ? 1 : 0;
        return is_there;
    }

    /// Adds to the length that the name has when it is written.
    [[nodiscard]] bool count_in(std::size_t more)
    {
        length_ += more;
        return length_ <= max_label_name_length ||
               fail_with("found more than " + std::to_string(max_label_name_length) +
                         " characters, with periods, indices and commas");
    }

    /// Reports a problem; always returns false.
    bool fail(std::string_view expected)
    {
        constexpr std::size_t enough = 40;
        const std::string_view rest = text_.substr(at_);
        const std::string found =
            rest.empty() ? "the end" : "'" + printable(rest.substr(0, enough), enough) + "'";
        return fail_with("found " + found + ", expected " + std::string{expected});
    }

    bool fail_with(std::string text)
    {
        problem_.where = "column " + std::to_string(characters(text_.substr(0, at_)) + 1);
        problem_.text = std::move(text);
        return false;
    }

    std::string_view text_;
    std::size_t at_{0};
    /// Number of characters read.
    std::size_t length_{0};
    Problem problem_{};
};

} // namespace

bool operator==(const LabelName::Part& a, const LabelName::Part& b)
{
    return a.indices == b.indices && busbar::detail::is_same_ignoring_case(a.name, b.name);
}

Configured<LabelName> parse_label_name(std::string_view text)
{
    return NameReader{text}.read();
}

std::string to_text(const LabelName& name)
{
    std::string text;
    for (const LabelName::Part& part : name.parts) {
        text += text.empty() ? "" : ".";
        text += part.name;
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            text += i == 0 ? "[" : ",";
            text += std::to_string(part.indices[i]);
        }
        text += part.indices.empty() ? "" : "]";
    }
    return text;
}

std::string key_of(const LabelName& name)
{
    std::string key = to_text(name);
    std::ranges::transform(key, key.begin(), busbar::detail::to_ascii_lower);
    return key;
}

TimerPart timer_part(const LabelName::Part& part)
{
    if (part.name.size() != 1 || !part.indices.empty()) {
        return TimerPart::None;
    }
    switch (busbar::detail::to_ascii_lower(part.name[0])) {
    case 's':
        return TimerPart::Contact;
    case 'c':
        return TimerPart::Coil;
    case 'n':
        return TimerPart::Current;
    default:
        return TimerPart::None;
    }
}

} // namespace busbar::backend
