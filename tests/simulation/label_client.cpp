#include "label_client.hpp"

#include <busbar/types/attribute.hpp>
#include <busbar/types/monitored_item.hpp>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t value_attribute = 13;

ReadValueId value_of(const std::string& name)
{
    ReadValueId id;
    id.node_id = NodeId{1, String{name}};
    id.attribute_id = value_attribute;
    return id;
}

} // namespace

std::string LabelBoard::name(std::size_t variable) const
{
    if (variable < written.size()) {
        return "Own" + std::to_string(variable);
    }
    return variable == mode_index() ? "Mode" : variable == count_index() ? "Count" : "Twin";
}

LabelClient::LabelClient(harness::World& world, LabelBoard& board, Trace& trace, std::size_t number,
                         Chance chance)
    : board_{board}, trace_{trace}, number_{number}, chance_{chance}, host_{world},
      confirmed_{board.written[number]}, seen_(board.variables()),
      told_(board.variables()), items_{number, (number + 1) % board.written.size(),
                                       board.count_index(), board.twin_index()},
      told_status_(board.variables()), next_{world.scheduler(), [this] { act(); }}
{
}

void LabelClient::start()
{
    if (!host_.connect()) {
        return violation("no connection");
    }
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = 200;
    create.requested_lifetime_count = 1'000;
    create.requested_max_keep_alive_count = 20;
    create.publishing_enabled = true;
    const auto made = host_.call<CreateSubscriptionResponse>(create);
    CreateMonitoredItemsRequest request;
    request.subscription_id = made ? made->subscription_id : 0;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (const std::size_t variable : items_) {
        MonitoredItemCreateRequest item;
        item.item_to_monitor = value_of(board_.name(variable));
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle = static_cast<std::uint32_t>(variable);
        item.requested_parameters.sampling_interval = 200;
        item.requested_parameters.queue_size = 5;
        request.items_to_create.push_back(item);
    }
    const auto items = host_.call<CreateMonitoredItemsResponse>(request);
    if (!items || items->results.size() != items_.size()) {
        return violation("no MonitoredItems");
    }
    publish();
    publish();
    next_.set_after(chance_.between(10ms, 1s));
}

void LabelClient::act()
{
    if (chance_.one_in(2) && !is_writing_) {
        write();
    } else {
        read();
    }
    next_.set_after(chance_.between(50ms, 1'500ms));
}

void LabelClient::read()
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (std::size_t i = 0; i < board_.variables(); ++i) {
        request.nodes_to_read.push_back(value_of(board_.name(i)));
    }
    host_.client().call<ReadResponse>(
        request, [this](Result<ReadResponse> response) { take_read(response); });
}

void LabelClient::write()
{
    const std::int32_t value = ++board_.written[number_];
    is_writing_ = true;
    WriteRequest request;
    WriteValue one;
    one.node_id = NodeId{1, String{board_.name(number_)}};
    one.attribute_id = value_attribute;
    one.value.value = Variant{value};
    request.nodes_to_write = {one};
    host_.client().call<WriteResponse>(
        request, [this, value](Result<WriteResponse> response) { take_write(response, value); });
}

void LabelClient::publish()
{
    PublishRequest request;
    if (to_acknowledge_) {
        request.subscription_acknowledgements = {*to_acknowledge_};
        to_acknowledge_.reset();
    }
    host_.client().call<PublishResponse>(request, [this](Result<PublishResponse> response) {
        if (is_over_) {
            return;
        }
        if (!response) {
            return violation("Publish: " + std::string{name(response.error())});
        }
        take_notification(*response);
        publish();
    });
}

bool LabelClient::check_service(const char* what, StatusCode result)
{
    trace_.note(number_, what, result.value());
    if (result != status::Good && result != status::Bad_TooManyOperations) { // 8.1, ServiceResult
        violation(std::string{what} + ": service " + std::string{name(result)});
    }
    return result == status::Good;
}

void LabelClient::take_read(const Result<ReadResponse>& response)
{
    if (is_over_ || !check_service("read", response ? StatusCode{} : response.error())) {
        return;
    }
    const auto& results = response->results;
    if (results.size() != board_.variables()) {
        return violation("another number of results");
    }
    for (std::size_t i = 0; i < results.size(); ++i) {
        check_value("read", i, results[i]);
        if (results[i].status != results[0].status) {
            violation("nodes of one request differ");
        }
        if (const auto* const number = results[i].value.get_if<std::int32_t>()) {
            if (*number < seen_[i]) {
                violation("read what was before: " + std::to_string(*number));
            }
            seen_[i] = *number;
        }
    }
    if (results[0].status.is_good() && !is_writing_) {
        const auto* const own = results[number_].value.get_if<std::int32_t>();
        if (own == nullptr || *own < confirmed_) {
            violation("its own value is not what it wrote");
        }
    }
    if (results[board_.count_index()].value != results[board_.twin_index()].value) {
        violation("torn");
    }
}

void LabelClient::take_write(const Result<WriteResponse>& response, std::int32_t value)
{
    is_writing_ = false;
    if (is_over_ || !check_service("write", response ? StatusCode{} : response.error())) {
        return;
    }
    const StatusCode result = response->results[0];
    trace_.note(number_, "written", result.value(), static_cast<std::uint64_t>(value));
    if (result == status::Good) {
        confirmed_ = value;
    } else if (result == status::Bad_NoCommunication) {
        ++bad_;
    } else {
        violation("write: " + std::string{name(result)});
    }
}

void LabelClient::take_notification(const PublishResponse& response)
{
    const auto& message = response.notification_message;
    for (const ExtensionObject& part : message.notification_data) {
        const auto* const data = part.get_if<DataChangeNotification>();
        if (data == nullptr) {
            violation("another notification");
            continue;
        }
        to_acknowledge_ =
            SubscriptionAcknowledgement{response.subscription_id, message.sequence_number};
        for (const MonitoredItemNotification& item : data->monitored_items) {
            check_value("told", item.client_handle, item.value);
            told_status_[item.client_handle] = item.value.status;
            if (const auto* const number = item.value.value.get_if<std::int32_t>()) {
                if (*number < told_[item.client_handle]) {
                    violation("told what was before");
                }
                told_[item.client_handle] = *number;
            }
        }
    }
}

void LabelClient::check_value(const char* what, std::size_t variable, const DataValue& data)
{
    const StatusCode result = data.status.code();
    const bool is_overload = result == StatusCode{status::Good_Overload};
    if (result == status::Bad_NoCommunication) { // 8.1 and 8.3
        ++bad_;
        return trace_.note(number_, what, variable, result.value());
    }
    if (result != status::Good && !(is_overload && what[0] == 't')) { // 10.3: MonitoredItems only
        return violation(std::string{what} + ": " + std::string{name(result)});
    }
    ++good_;
    overloads_ += is_overload ? 1 : 0;
    if (variable == board_.mode_index()) {
        if (data.value != Variant{LabelBoard::mode}) {
            violation("Mode is wrong");
        }
        return;
    }
    const auto* const number = data.value.get_if<std::int32_t>();
    if (number == nullptr) {
        return violation("another type");
    }
    check_number(what, variable, *number);
}

void LabelClient::check_number(const char* what, std::size_t variable, std::int32_t number)
{
    trace_.note(number_, what, variable, static_cast<std::uint64_t>(number));
    if (variable >= board_.written.size()) {
        return; // Count and Twin
    }
    const auto least = static_cast<std::int32_t>(variable) * LabelBoard::step;
    if (number < least || number > board_.written[variable]) {
        violation(board_.name(variable) + " is " + std::to_string(number));
    }
}

void LabelClient::check_end()
{
    const auto response = host_.call<ReadResponse>([this] {
        ReadRequest request;
        request.nodes_to_read = {value_of(board_.name(number_))};
        return request;
    }());
    if (!response || response->results[0].status != status::Good ||
        response->results[0].value != Variant{confirmed_}) {
        violation("at the end its own value is not what it wrote");
    }
    if (told_[number_] != confirmed_ || told_status_[number_] != status::Good) {
        violation("at the end it was not told of its own value");
    }
}

void LabelClient::leave()
{
    next_.cancel();
    is_over_ = true;
}

} // namespace busbar::test
