#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "kept_world.hpp"
#include "service/request_content.hpp"
#include "service/service_world.hpp"
#include "service/steps.hpp"
#include "target.hpp"

namespace service_fuzz {

using namespace busbar;
using fuzz::RequestTypes;
using fuzz::ServiceWorld;
using fuzz::Step;

namespace {

using Payload = std::vector<std::uint8_t>;

std::uint32_t encoding_of(const Payload& payload)
{
    return payload.size() < 2 ? 0 : payload[0] + payload[1] * 256U;
}

std::span<const std::byte> body_of(const Payload& payload)
{
    return std::as_bytes(std::span{payload}).subspan(std::min<std::size_t>(payload.size(), 2));
}

/// Nothing if the bytes are no request of that type.
std::optional<binary::DynamicValue> request_of(const Payload& payload)
{
    const auto* const entry = RequestTypes::all().find(encoding_of(payload));
    if (entry == nullptr) {
        return {};
    }
    auto value = binary::decode_dynamic(body_of(payload), *entry->request);
    return value ? std::optional{std::move(*value)} : std::nullopt;
}

void play(ServiceWorld& world, const Step& step)
{
    const std::size_t session = step.is_of_other_session() ? 1 : 0;
    const std::uint8_t first = step.payload.empty() ? 0 : step.payload[0];
    switch (step.kind()) {
    case Step::Kind::Request:
        if (auto request = request_of(step.payload)) {
            const auto* const entry = RequestTypes::all().find(encoding_of(step.payload));
            return world.send(session, *entry, std::move(*request));
        }
        [[fallthrough]];
    case Step::Kind::RawRequest:
        return world.send_raw(session, encoding_of(step.payload), body_of(step.payload));
    case Step::Kind::Time:
        return world.advance(std::chrono::milliseconds{first * 40});
    case Step::Kind::Backend:
        return world.act(first);
    }
}

} // namespace

/// One request or a few, of the whole table of services, in two sessions.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static fuzz::KeptWorld<ServiceWorld> kept;
    ServiceWorld& world = kept.next();
    world.begin();
    for (const Step& step : fuzz::read_steps({data, size})) {
        play(world, step);
    }
    world.end();
    if (world.is_used_up()) {
        kept.drop();
    }
    return 0;
}

namespace {

Payload payload_of(const binary::DynamicValue& request)
{
    Payload payload;
    const auto body = binary::to_bytes(request);
    if (body) {
        const std::uint32_t encoding = request.type().encoding_id.numeric();
        payload = {static_cast<std::uint8_t>(encoding % 256),
                   static_cast<std::uint8_t>(encoding / 256)};
        payload.resize(2 + body->size());
        std::memcpy(payload.data() + 2, body->data(), body->size());
    }
    return payload;
}

Step new_step(fuzz::RequestContent& content)
{
    Step step;
    step.action = static_cast<std::uint8_t>(content.below(64));
    if (step.kind() == Step::Kind::Request || step.kind() == Step::Kind::RawRequest) {
        const auto encodings = RequestTypes::all().encodings();
        const auto* const entry =
            RequestTypes::all().find(encodings[content.below(encodings.size())]);
        step.payload = payload_of(content.structure(*entry->request));
    } else {
        step.payload = {static_cast<std::uint8_t>(content.below(256))};
    }
    return step;
}

/// Bytes as libFuzzer would change them by itself.
void change_bytes(Payload& payload)
{
    const std::size_t size = payload.size();
    payload.resize(size + 64);
    payload.resize(fuzz::mutate_bytes(payload.data(), size, payload.size()));
}

void change_step(fuzz::RequestContent& content, Step& step)
{
    if (step.kind() == Step::Kind::Request && content.below(8) != 0) {
        if (auto request = request_of(step.payload)) {
            for (std::size_t i = content.below(3) + 1; i != 0; --i) {
                content.change(*request);
            }
            step.payload = payload_of(*request);
            return;
        }
    }
    change_bytes(step.payload);
}

} // namespace

/// Requests stay requests: their fields get other content.
std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed)
{
    fuzz::RequestContent content{seed};
    std::vector<Step> steps = fuzz::read_steps({data, size});
    const std::size_t choice = content.below(8);
    if (steps.empty() || (choice == 0 && steps.size() < fuzz::max_steps)) {
        steps.insert(steps.begin() + static_cast<std::ptrdiff_t>(content.below(steps.size() + 1)),
                     new_step(content));
    } else if (choice == 1) {
        steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(content.below(steps.size())));
    } else if (choice == 2) {
        std::swap(steps[content.below(steps.size())], steps[content.below(steps.size())]);
    } else if (choice == 3) {
        steps.push_back(steps[content.below(steps.size())]);
    } else {
        change_step(content, steps[content.below(steps.size())]);
    }
    const std::vector<std::uint8_t> bytes = fuzz::written(steps, max_size);
    std::copy(bytes.begin(), bytes.end(), data);
    return bytes.size();
}

} // namespace service_fuzz
