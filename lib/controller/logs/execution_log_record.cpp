#include <busbar/controller/execution_log_record.hpp>

#include <algorithm>
#include <array>

#include "execution_log_details.hpp"
#include "log_text.hpp"

namespace busbar::controller {

namespace {

/// W588, 7-1-6, without the hyphens of its line breaks. Discard is 0103: 9-3 errs. Expired_Client
/// is our own: by 5-1-1 this log tells of it, and 7-1-6 has no code for it.
constexpr std::array log_codes{
    ExecutionLogCode{"SERVER", 1, "Start", "OPC UA Server started"},
    ExecutionLogCode{"SERVER", 4, "Prepare", "Preparing of OPC UA Server started"},
    ExecutionLogCode{"SERVER", 5, "Run", "OPC UA Server running"},
    ExecutionLogCode{"SERVER", 6, "Shutdown", "OPC UA Server shutdown completed"},
    ExecutionLogCode{"SERVER", 7, "HaltError", "OPC UA Server error"},
    ExecutionLogCode{"SERVER", 100, "MaxVariables",
                     "Maximum number of variables that can be published is exceeded"},
    ExecutionLogCode{"SERVER", 101, "InvalidDataType", "Variable including unsupported data type"},
    ExecutionLogCode{"SERVER", 110, "NumOfVariables", "Number of OPC UA public variables"},
    ExecutionLogCode{"SERVER", 111, "PublishedVariable", "Details of OPC UA public variables"},
    ExecutionLogCode{"AUTH", 1, "Application", "Application authentication"},
    ExecutionLogCode{"AUTH", 2, "User", "User authentication"},
    ExecutionLogCode{"AUTH", 100, "Update", "Security settings updated"},
    ExecutionLogCode{"CERT", 1, "Update_Server", "Server certificate updated"},
    ExecutionLogCode{"CERT", 2, "Notify_Server", "Notice of expiration of server certificate"},
    ExecutionLogCode{"CERT", 3, "Expired_Server", "Server certificate expired"},
    ExecutionLogCode{"CERT", 4, "Mismatch_Host", "Server certificate mismatch"},
    ExecutionLogCode{"CERT", 100, "Add", "Certificate added"},
    ExecutionLogCode{"CERT", 101, "Delete", "Certificate deleted"},
    ExecutionLogCode{"CERT", 102, "Move", "Certificate moved"},
    ExecutionLogCode{"CERT", 103, "Discard", "Certificate discarded"},
    ExecutionLogCode{"CERT", 104, "Expired_Client", "Client certificate expired"},
    ExecutionLogCode{"CERT", 200, "Add_Crl", "Certificate Revocation List added"},
    ExecutionLogCode{"CERT", 201, "Delete_Crl", "Certificate Revocation List deleted"},
};

} // namespace

std::span<const ExecutionLogCode> execution_log_codes()
{
    return log_codes;
}

bool is_in_execution_log(RecordKind kind)
{
    return detail::has_log_rule(kind);
}

std::vector<ExecutionLogItem> execution_log_items(const Record& record, DateTime now)
{
    std::vector<ExecutionLogItem> items;
    for (detail::LogDetails& found : detail::log_details(record, now)) {
        const auto code = std::find_if(log_codes.begin(), log_codes.end(), [&](const auto& each) {
            return each.name == found.log_name;
        });
        if (code != log_codes.end()) {
            items.push_back(
                {&*code, std::string{detail::cut_text(found.details, max_execution_log_details)}});
        }
    }
    return items;
}

std::string execution_log_record(std::uint16_t serial_number, DateTime time, TimeZone zone,
                                 const ExecutionLogItem& item)
{
    const detail::LocalTimeTexts local = detail::local_time_texts(time, zone);
    const std::string code = detail::padded(item.code->code, 4);
    std::string line = std::to_string(serial_number);
    for (const std::string_view part : {std::string_view{local.date}, std::string_view{local.time},
                                        std::string_view{local.millisecond}, item.code->category,
                                        std::string_view{code}, item.code->name}) {
        line.append("\t").append(part);
    }
    if (!item.details.empty()) {
        line.append("\t").append(detail::cut_text(item.details, max_execution_log_details));
    }
    return line + "\r\n";
}

} // namespace busbar::controller
