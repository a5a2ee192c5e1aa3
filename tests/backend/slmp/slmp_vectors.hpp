#pragma once

#include <array>
#include <charconv>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <busbar/backend/slmp_message.hpp>

/// The rows of tests/vectors/slmp.jsonl and slmp-frames.jsonl as operations and answers.
namespace busbar::test {

using Json = nlohmann::json;

inline std::vector<Json> slmp_rows(const std::string& name)
{
    std::ifstream file{BUSBAR_SOURCE_DIR "/tests/vectors/" + name};
    REQUIRE(file);
    std::vector<Json> rows;
    for (std::string line; std::getline(file, line);) {
        rows.push_back(Json::parse(line));
    }
    REQUIRE_FALSE(rows.empty());
    return rows;
}

inline std::vector<std::byte> bytes_of(const Json& hex)
{
    const auto text = hex.get<std::string>();
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(std::stoul(text.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

inline std::string hex_of(std::span<const std::byte> bytes)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::byte byte : bytes) {
        text += digits[std::to_integer<unsigned>(byte) >> 4U];
        text += digits[std::to_integer<unsigned>(byte) & 15U];
    }
    return text;
}

inline std::uint16_t code_of(const Json& hex)
{
    return static_cast<std::uint16_t>(std::stoul(hex.get<std::string>(), nullptr, 16));
}

/// "D100"; "G22" only together with the module that it is in.
inline backend::SlmpDevice device_of(const Json& name, const Json& row = Json::object())
{
    auto text = name.get<std::string>();
    if (row.contains("extension")) {
        std::array<char, 8> module{};
        const auto end = std::to_chars(module.data(), module.data() + module.size(),
                                       row["extension"].get<unsigned>(), 16);
        text = "U" + std::string{module.data(), end.ptr} + "\\" + text;
    }
    INFO(text);
    const auto address = backend::parse_slmp_address(text);
    REQUIRE(address);
    if (row.contains("direct_memory")) {
        CHECK(address->device.direct_memory == code_of(row["direct_memory"]));
    }
    return address->device;
}

inline void append_words(std::vector<std::uint16_t>& words, const Json& values, bool is_double)
{
    for (const auto& value : values.is_array() ? values : Json::array({values})) {
        const auto number = value.is_boolean() ? value.get<bool>() : value.get<std::uint32_t>();
        words.push_back(static_cast<std::uint16_t>(number));
        if (is_double) {
            words.push_back(static_cast<std::uint16_t>(number >> 16U));
        }
    }
}

/// Reads "D0", ["D0", points], ["D0", value] and ["D0", [values]].
inline std::vector<backend::SlmpBlock>
blocks_of(backend::SlmpOperation& operation, const Json& entries, bool is_double, bool has_points)
{
    std::vector<backend::SlmpBlock> blocks;
    for (const auto& entry : entries) {
        backend::SlmpBlock block{device_of(entry.is_array() ? entry[0] : entry)};
        if (entry.is_array() && entry[1].is_number() && has_points) {
            block.points = entry[1].get<std::uint16_t>();
        } else if (entry.is_array()) {
            block.points =
                static_cast<std::uint16_t>(entry[1].is_array() ? entry[1].size() : std::size_t{1});
            append_words(operation.words, entry[1], is_double);
        }
        blocks.push_back(block);
    }
    return blocks;
}

inline void add_labels(backend::SlmpOperation& operation, const Json& fields)
{
    for (const auto& name : fields["abbreviations"]) {
        operation.abbreviations.push_back(name.get<std::string>());
    }
    for (const auto& entry : fields["labels"]) {
        backend::SlmpLabel label{.name = entry["name"].get<std::string>()};
        const bool is_array = entry.contains("unit");
        label.is_in_bits = is_array && entry["unit"] == 0;
        label.length = is_array ? entry["length"].get<std::uint16_t>() : std::uint16_t{0};
        if (entry.contains("data")) {
            label.data = bytes_of(entry["data"]);
        }
        operation.labels.push_back(std::move(label));
    }
}

/// The operation that the fields of a row describe.
inline backend::SlmpOperation operation_of(std::uint16_t command, std::uint16_t subcommand,
                                           const Json& fields)
{
    using backend::SlmpCommand;
    backend::SlmpOperation operation;
    operation.command = static_cast<SlmpCommand>(command);
    operation.is_bits = (subcommand & 1U) != 0;
    operation.has_long_form = (subcommand & 2U) != 0;
    const bool is_list = operation.command == SlmpCommand::RandomRead ||
                         operation.command == SlmpCommand::RandomWrite;
    if (fields.contains("device")) {
        auto points = fields.value("points", std::uint16_t{0});
        for (const char* const name : {"words", "values"}) {
            if (fields.contains(name)) {
                append_words(operation.words, fields[name], false);
                points = static_cast<std::uint16_t>(operation.words.size());
            }
        }
        operation.blocks = {{device_of(fields["device"], fields), points}};
    } else if (fields.contains("device_code")) {
        operation.blocks = {
            {{code_of(fields["device_code"]), fields["number"].get<std::uint32_t>()},
             fields["points"].get<std::uint16_t>()}};
    } else if (is_list || fields.contains("registered")) {
        const Json& lists = is_list ? fields : fields["registered"];
        operation.blocks = blocks_of(
            operation, lists.contains("bits") ? lists["bits"] : lists["words"], false, false);
        const char* const doubles = lists.contains("double_words") ? "double_words" : "dwords";
        if (lists.contains(doubles)) {
            operation.more_blocks = blocks_of(operation, lists[doubles], true, false);
        }
    } else if (fields.contains("word_blocks")) {
        operation.blocks = blocks_of(operation, fields["word_blocks"], false, true);
        operation.more_blocks = blocks_of(operation, fields["bit_blocks"], false, true);
    } else if (fields.contains("labels")) {
        add_labels(operation, fields);
    }
    for (const char* const name : {"data", "password"}) {
        operation.text = fields.contains(name) ? fields[name].get<std::string>() : operation.text;
    }
    for (const char* const name : {"mode", "fixed"}) {
        operation.mode = fields.value(name, operation.mode);
    }
    operation.clear = fields.value("clear", operation.clear);
    return operation;
}

inline backend::SlmpStation station_of(const Json& row)
{
    return {row["network"].get<std::uint8_t>(), row["station"].get<std::uint8_t>(),
            row["module"].get<std::uint16_t>(), row["multidrop"].get<std::uint8_t>()};
}

/// The answer that the fields of a row describe.
inline backend::SlmpAnswer answer_of(const Json& fields)
{
    backend::SlmpAnswer answer;
    answer.end_code = code_of(fields["end_code"]);
    if (fields.contains("error")) {
        const Json& error = fields["error"];
        answer.error = {station_of(error), code_of(error["command"]), code_of(error["subcommand"])};
    }
    for (const char* const name : {"words", "bits", "dwords"}) {
        if (fields.contains(name)) {
            append_words(answer.words, fields[name], std::string_view{name} == "dwords");
        }
    }
    if (fields.contains("labels")) {
        for (const auto& entry : fields["labels"]) {
            answer.labels.push_back(
                {entry["type"].get<std::uint8_t>(),
                 static_cast<std::uint8_t>(entry.contains("unit") ? entry["unit"] : entry["spare"]),
                 entry["length"].get<std::uint16_t>(), bytes_of(entry["data"])});
        }
    }
    answer.text = fields.value("data", fields.value("model", std::string{}));
    answer.model = fields.contains("model_code") ? code_of(fields["model_code"]) : std::uint16_t{0};
    return answer;
}

} // namespace busbar::test
