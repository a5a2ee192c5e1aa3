#pragma once

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <busbar/backend/modbus_pdu.hpp>

/// The rows of tests/vectors/modbus-frames.jsonl: frames of other implementations' tests and of
/// documents, with what they contain.
namespace busbar::test {

using Json = nlohmann::json;

struct ModbusRow {
    std::string name;
    std::uint16_t transaction{0};
    std::uint8_t unit{0};
    backend::ModbusRequest asked{};
    backend::ModbusResponse answered{};
    std::vector<std::byte> request{};
    std::vector<std::byte> response{};
    /// The request is wrong on purpose.
    bool is_refused{false};
};

inline std::vector<std::byte> bytes_of_hex(const std::string& hex)
{
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

inline backend::ModbusRequest modbus_request_of(std::uint8_t function, const Json& fields)
{
    backend::ModbusRequest request;
    const auto number = [&](const char* key, unsigned otherwise) {
        return fields.value(key, otherwise);
    };
    const auto word = [&](const char* key) { return static_cast<std::uint16_t>(number(key, 0)); };
    request.function = static_cast<backend::ModbusFunction>(function);
    request.address = fields.contains("read_address") ? word("read_address") : word("address");
    request.write_address = word("write_address");
    request.and_mask = word("and_mask");
    request.or_mask = word("or_mask");
    request.read_code = static_cast<std::uint8_t>(number("read_code", 1));
    request.object = static_cast<std::uint8_t>(number("object", 0));
    for (const char* const key : {"bits", "registers"}) {
        if (fields.contains(key)) {
            request.values = fields[key].get<std::vector<std::uint16_t>>();
        }
    }
    for (const char* const key : {"value", "raw_value"}) {
        if (fields.contains(key)) {
            request.values = {word(key)};
        }
    }
    if (request.values.empty()) {
        request.quantity = static_cast<std::uint16_t>(number("quantity", 1));
    }
    if (fields.contains("read_quantity")) {
        request.quantity = word("read_quantity");
    }
    return request;
}

inline backend::ModbusResponse modbus_response_of(const backend::ModbusRequest& asked,
                                                  const Json& fields)
{
    backend::ModbusResponse response;
    response.function = asked.function;
    if (fields.contains("exception")) {
        response.exception = static_cast<backend::ModbusException>(fields["exception"].get<int>());
    }
    for (const char* const key : {"bits", "registers"}) {
        if (fields.contains(key)) {
            response.values = fields[key].get<std::vector<std::uint16_t>>();
        }
    }
    if (fields.contains("objects")) {
        backend::ModbusIdentification& all = response.identification;
        all.read_code = fields["read_code"].get<std::uint8_t>();
        all.conformity = fields["conformity"].get<std::uint8_t>();
        for (const Json& object : fields["objects"]) {
            all.objects.push_back({object[0].get<std::uint8_t>(), object[1].get<std::string>()});
        }
    }
    return response;
}

inline std::vector<ModbusRow> modbus_rows()
{
    const char* const chosen = std::getenv("BUSBAR_VECTORS");
    const std::string folder = chosen != nullptr ? chosen : BUSBAR_SOURCE_DIR "/tests/vectors";
    std::ifstream file{folder + "/modbus-frames.jsonl"};
    std::vector<ModbusRow> rows;
    for (std::string line; std::getline(file, line);) {
        const Json json = Json::parse(line);
        ModbusRow row;
        row.name = json["name"];
        row.transaction = json["transaction"].get<std::uint16_t>();
        row.unit = json["unit"].get<std::uint8_t>();
        const Json& asked = json["request_fields"];
        row.asked = modbus_request_of(json["function"].get<std::uint8_t>(), asked);
        row.answered = modbus_response_of(row.asked, json["response_fields"]);
        row.request = bytes_of_hex(json["request"]);
        row.response = bytes_of_hex(json["response"]);
        std::vector<std::byte> ignored;
        row.is_refused = asked.contains("data") || asked.contains("raw_value") ||
                         !encode_modbus(row.asked, ignored);
        rows.push_back(std::move(row));
    }
    return rows;
}

} // namespace busbar::test
