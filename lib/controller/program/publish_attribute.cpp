#include "publish_attribute.hpp"

#include <array>
#include <string>

#include "core/ascii_case.hpp"
#include "declaration_lexer.hpp"

namespace busbar::controller::detail {

namespace {

struct PublishWord {
    std::string_view word;
    NetworkPublish publish;
};

/// The words without the characters allowed between them.
constexpr std::array publish_words{
    PublishWord{"none", NetworkPublish::Hidden},
    PublishWord{"hidden", NetworkPublish::Hidden},
    PublishWord{"donotpublish", NetworkPublish::Hidden},
    PublishWord{"publishonly", NetworkPublish::PublishOnly},
    PublishWord{"publiconly", NetworkPublish::PublishOnly},
    PublishWord{"public", NetworkPublish::PublishOnly},
    PublishWord{"input", NetworkPublish::Input},
    PublishWord{"output", NetworkPublish::Output},
};

/// Longer than any entry of the table with characters between its words.
constexpr std::size_t longest_word = 40;

std::string_view without_quotes(std::string_view text)
{
    const bool is_quoted = text.size() > 1 && text.front() == text.back() &&
                           (text.front() == '\'' || text.front() == '"');
    return is_quoted ? trimmed_text(text.substr(1, text.size() - 2)) : text;
}

/// Removes the word attribute if the text begins with it.
std::string_view without_attribute(std::string_view text)
{
    constexpr std::string_view word = "attribute";
    const bool begins =
        text.size() > word.size() &&
        busbar::detail::is_same_ignoring_case(text.substr(0, word.size()), word) &&
        std::string_view{" \t\r\n'\""}.find(text[word.size()]) != std::string_view::npos;
    return begins ? trimmed_text(text.substr(word.size())) : text;
}

} // namespace

std::optional<NetworkPublish> publish_of(std::string_view words)
{
    std::string plain;
    if (words.size() <= longest_word) {
        for (const char c : words) {
            if (c != ' ' && c != '-' && c != '_') {
                plain += busbar::detail::to_ascii_lower(c);
            }
        }
    }
    for (const PublishWord& row : publish_words) {
        if (row.word == plain) {
            return row.publish;
        }
    }
    return {};
}

PublishPragma read_publish_pragma(std::string_view text)
{
    const std::size_t assign = text.find(":=");
    if (assign == std::string_view::npos) {
        return {};
    }
    const std::string_view name =
        without_quotes(without_attribute(trimmed_text(text.substr(0, assign))));
    const std::string_view value = without_quotes(trimmed_text(text.substr(assign + 2)));
    if (busbar::detail::is_same_ignoring_case(name, "OPC.UA.DA")) {
        return {true, value == "1"   ? std::optional{NetworkPublish::PublishOnly}
                      : value == "0" ? std::optional{NetworkPublish::Hidden}
                                     : std::nullopt};
    }
    if (busbar::detail::is_same_ignoring_case(name, "publish")) {
        return {true, publish_of(value)};
    }
    return {};
}

} // namespace busbar::controller::detail
