#include "english.hpp"

#include <algorithm>
#include <array>
#include <regex>
#include <sstream>

namespace busbar::tidy {

namespace {

/// Where the comment of a line begins, past string literals; npos if it has none.
std::size_t comment_begin(std::string_view line)
{
    bool is_quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '\\') {
            ++i;
        } else if (line[i] == '"' && (i == 0 || line[i - 1] != '\'')) {
            is_quoted = !is_quoted;
        } else if (!is_quoted && line.substr(i, 2) == "//") {
            return i;
        }
    }
    return std::string_view::npos;
}

/// The text of a comment without slashes; `is_doc` if it has three of them.
std::string comment_text(std::string_view comment, bool& is_doc, bool& is_trailing)
{
    is_doc = comment.substr(0, 3) == "///";
    comment.remove_prefix(is_doc ? 3 : 2);
    is_trailing = comment.substr(0, 1) == "<";
    comment.remove_prefix(is_trailing ? 1 : 0);
    comment.remove_prefix(std::min(comment.find_first_not_of(' '), comment.size()));
    return std::string{comment};
}

std::size_t count_matches(const std::string& text, const std::regex& pattern)
{
    return static_cast<std::size_t>(
        std::distance(std::sregex_iterator{text.begin(), text.end(), pattern}, {}));
}

/// Matches of the pattern without those of its first group, which are good English.
std::size_t count_others(const std::string& text, const std::regex& pattern)
{
    std::size_t count = 0;
    for (std::sregex_iterator match{text.begin(), text.end(), pattern};
         match != std::sregex_iterator{}; ++match) {
        count += (*match)[1].matched ? 0 : 1;
    }
    return count;
}

constexpr std::array<std::string_view, 13> stack_layers = {
    "core",   "binary",  "storage", "crypto", "channel", "model",      "server",
    "client", "backend", "net",     "c",      "harness", "harness_net"};

} // namespace

std::vector<Prose> comments(const File& file)
{
    std::vector<Prose> found;
    bool goes_on = false;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string& line = file.lines[i];
        const std::size_t begin = comment_begin(line);
        if (begin == std::string::npos) {
            goes_on = false;
            continue;
        }
        bool is_doc = false;
        bool is_trailing = false;
        const std::string text = comment_text(line.substr(begin), is_doc, is_trailing);
        const bool is_alone = line.find_first_not_of(' ') == begin;
        if (goes_on && is_alone && found.back().is_doc == is_doc) {
            found.back().text += " " + text;
        } else {
            found.push_back({i, text, is_doc});
        }
        goes_on = true;
    }
    return found;
}

std::vector<Prose> literals(const File& file)
{
    static const std::regex literal{R"re("((?:[^"\\]|\\.)*)")re", std::regex::optimize};
    std::vector<Prose> found;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string code = file.lines[i].substr(0, comment_begin(file.lines[i]));
        if (code.find('"') == std::string::npos || code.front() == '#') {
            continue;
        }
        for (std::sregex_iterator match{code.begin(), code.end(), literal};
             match != std::sregex_iterator{}; ++match) {
            const std::string text = (*match)[1];
            if (text.find(' ') != std::string::npos) {
                found.push_back({i, text, false});
            }
        }
    }
    return found;
}

std::map<std::string, std::size_t> count_phrases(const Prose& prose)
{
    constexpr auto options = std::regex::icase | std::regex::optimize;
    static const std::regex fragment{
        "(Of|What|Who|Whose|Whom|Whoever|Whatever|Which|Why|Those|Theirs|To be|How|Where|By|As|"
        "From (?!now|then)|For (the|those|one|what|who|which|whom)|Has|Have|In (what|which)|"
        "With (the|what|which)|Somebody|Something)\\b.*",
        std::regex::optimize};
    static const std::regex behind{R"(\bbehind\b)", options};
    static const std::regex nobody{
        R"(((?:user|person|administrator|operator)s? )?\b(nobody|whoever|who|whom|somebody)\b)",
        options};
    static const std::regex is_no{
        R"((there )?\b(?:is|are|was|were) no (?!longer|(?:more|less|\w+er) than)|\banew\b)",
        options};
    std::map<std::string, std::size_t> counts;
    if (prose.is_doc) {
        counts["fragment"] = std::regex_match(prose.text, fragment) ? 1 : 0;
    }
    counts["behind"] = count_matches(prose.text, behind);
    counts["nobody"] = count_others(prose.text, nobody);
    counts["is-no"] = count_others(prose.text, is_no);
    return counts;
}

std::string_view prose_area(std::string_view path)
{
    if (path.substr(0, 8) == "include/") {
        return "include";
    }
    // These files quote what they look for.
    if (path.substr(0, 11) == "tests/tidy/") {
        return "";
    }
    for (const std::string_view area : {"tests", "examples"}) {
        if (path.substr(0, path.find('/')) == area) {
            return area;
        }
    }
    if (path.substr(0, 4) != "lib/") {
        return "";
    }
    const std::string_view layer = path.substr(4, path.find('/', 4) - 4);
    const bool is_stack =
        std::find(stack_layers.begin(), stack_layers.end(), layer) != stack_layers.end();
    return is_stack ? "stack" : "controller";
}

void PhraseCounts::add(const File& file)
{
    const std::string area{prose_area(file.path)};
    const auto count = [&](const std::string& in, const std::vector<Prose>& texts) {
        for (const Prose& prose : texts) {
            for (const auto& [phrase, number] : count_phrases(prose)) {
                std::vector<std::string>& found = places[{in, phrase}];
                found.insert(found.end(), number,
                             file.path + ":" + std::to_string(prose.line + 1) + ": " + prose.text);
            }
        }
    };
    if (!area.empty()) {
        count(area, comments(file));
        count(area + "-messages", literals(file));
    }
}

Findings check_phrases(const PhraseCounts& counts, const std::vector<std::string>& ceilings)
{
    // Changes that meet on a branch move a count a little, which is no reason to fail.
    constexpr std::size_t slack = 30;
    std::map<std::pair<std::string, std::string>, std::size_t> limits;
    for (const std::string& line : ceilings) {
        std::istringstream fields{line};
        std::string area;
        std::string phrase;
        std::size_t limit = 0;
        if (fields >> area >> phrase >> limit) {
            limits[{area, phrase}] = limit;
        }
    }
    Findings findings;
    for (const auto& [key, places] : counts.places) {
        const std::string name = key.first + " " + key.second;
        const std::string has = name + ": found " + std::to_string(places.size());
        const auto limit = limits.find(key);
        const std::size_t most = limit == limits.end() ? 0 : limit->second;
        if (places.size() > most) {
            findings.push_back(has + ", at most " + std::to_string(most) + " are allowed");
            findings.insert(findings.end(), places.begin(), places.end());
        } else if (places.size() + slack < most) {
            findings.push_back(has + ", lower its ceiling of " + std::to_string(most));
        }
    }
    return findings;
}

} // namespace busbar::tidy
