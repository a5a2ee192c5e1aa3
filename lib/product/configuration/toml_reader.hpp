#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <busbar/core/problem.hpp>
#include <busbar/core/result.hpp>

#include "product/store/source_files.hpp"
#include "toml.hpp"

namespace busbar::product {

/// A Problem for main(): "controller.toml:12: scan_ms: found \"x\", expected ...".
class ConfigError : public std::runtime_error {
public:
    explicit ConfigError(Problem problem)
        : std::runtime_error{text(problem)}, problem_{std::move(problem)}
    {
    }
    ConfigError(std::string where, std::string text)
        : ConfigError{Problem{.where = std::move(where), .text = std::move(text)}}
    {
    }
    [[nodiscard]] const Problem& problem() const { return problem_; }

private:
    Problem problem_;
};

/// Returns the value, or throws a ConfigError with the problem.
template <typename T>
T expect(Configured<T> made)
{
    if (!made) {
        throw ConfigError{std::move(made).error()};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(made);
    }
}

/// Returns the value, or throws the ConfigError "listening: failed" with the status.
template <typename T>
T expect(Result<T> result, const std::string& what)
{
    if (!result) {
        throw ConfigError{Problem{result.error(), what, "failed"}};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(result);
    }
}

/// A table of a configuration file. Every function throws a ConfigError with the place if the
/// content is not as expected.
class TomlTable {
public:
    /// `sources` reads the files that the table names. Both must outlive this object.
    TomlTable(const toml::table& table, std::string file, SourceFiles& sources)
        : table_{&table}, file_{std::move(file)}, sources_{&sources}
    {
    }

    /// Refuses any other key as a mistake.
    void allow(std::initializer_list<std::string_view> keys) const
    {
        allow(std::span{keys.begin(), keys.size()});
    }
    void allow(std::span<const std::string_view> keys) const;

    [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }
    [[nodiscard]] std::string text(std::string_view key, std::string otherwise) const;
    [[nodiscard]] std::string text(std::string_view key) const;
    [[nodiscard]] bool flag(std::string_view key, bool otherwise) const;
    [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t otherwise,
                                       std::int64_t least, std::int64_t most) const;
    [[nodiscard]] double number(std::string_view key, double otherwise) const;
    [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
    [[nodiscard]] std::vector<std::int64_t> integers(std::string_view key, std::int64_t least,
                                                     std::int64_t most) const;
    /// An empty table if the key is missing.
    [[nodiscard]] TomlTable table(std::string_view key) const;
    /// Returns the tables of [[key]].
    [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;
    [[nodiscard]] const toml::node* node(std::string_view key) const { return table_->get(key); }

    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] SourceFiles& sources() const { return *sources_; }

    /// Throws at a key, or at the table itself if the key is missing.
    [[noreturn]] void fail(std::string_view key, const std::string& expected) const;
    /// The same with a whole text that tells what was found and what was expected.
    [[noreturn]] void refuse(std::string_view key, const std::string& text) const;

private:
    [[nodiscard]] std::string place(const toml::node& node) const;

    const toml::table* table_;
    std::string file_;
    SourceFiles* sources_;
};

} // namespace busbar::product
