#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <busbar/backend/label_backend.hpp>

namespace busbar::test {

using backend::LabelKind;
using backend::LabelRequest;
using backend::LabelStatus;
using backend::LabelType;
using backend::ResolvedLabel;

/// A PLC whose answers a test scripts: at once, or when the test says so.
class FakeLabels final : public backend::LabelBackend {
public:
    void start(std::unique_ptr<LabelRequest> request) override
    {
        ++started[request->kind];
        if (requests.size() >= room) {
            request->status = LabelStatus::TooManyOperations;
            listener->done(std::move(request));
            return;
        }
        if (request->kind == LabelRequest::Kind::Sample) {
            sample_offsets.clear();
            scan = 0;
        }
        requests.push_back(std::move(request));
        if (is_prompt) {
            answer();
        }
    }
    void attach(backend::LabelListener* l) override { listener = l; }
    std::uint64_t sampled(std::span<std::byte> bytes, DateTime& when) override
    {
        if (scan == 0) {
            return 0;
        }
        REQUIRE(bytes.size() == scanned.size());
        std::copy(scanned.begin(), scanned.end(), bytes.begin());
        when = scan_time;
        return scan;
    }

    /// A label and its value.
    template <typename T>
    void add(const std::string& name, LabelType type, T value)
    {
        const std::uint64_t address = next_address++;
        labels[name] = {{}, {type}, address, false};
        labels[name].error = backend::LabelError::None;
        std::vector<std::byte> bytes(backend::size_of({type}));
        std::memcpy(bytes.data(), &value, std::min(bytes.size(), sizeof value));
        memory[address] = bytes;
    }
    template <typename T>
    void set(const std::string& name, T value)
    {
        auto& bytes = memory.at(labels.at(name).address);
        std::memcpy(bytes.data(), &value, std::min(bytes.size(), sizeof value));
    }
    template <typename T>
    [[nodiscard]] T get(const std::string& name) const
    {
        T value{};
        const auto& bytes = memory.at(labels.at(name).address);
        std::memcpy(&value, bytes.data(), std::min(bytes.size(), sizeof value));
        return value;
    }
    /// An online change: every label has another address.
    void move_labels(bool tells = false)
    {
        for (auto& [name, label] : labels) {
            const auto at = memory.extract(label.address);
            label.address = next_address++;
            memory[label.address] = at.mapped();
        }
        if (tells && listener != nullptr) {
            listener->labels_changed();
        }
    }

    /// Answers the oldest request.
    void answer()
    {
        auto request = std::move(requests.front());
        requests.pop_front();
        serve(*request);
        if (listener != nullptr) {
            listener->done(std::move(request));
        }
    }
    /// The PLC samples what it was asked to.
    void sample(std::int64_t milliseconds)
    {
        scanned.clear();
        for (const std::uint64_t address : sample_offsets) {
            const auto& bytes = memory.at(address);
            scanned.insert(scanned.end(), bytes.begin(), bytes.end());
        }
        ++scan;
        scan_time = DateTime{milliseconds * 10'000};
    }

    std::map<std::string, ResolvedLabel> labels;
    std::map<std::uint64_t, std::vector<std::byte>> memory;
    std::deque<std::unique_ptr<LabelRequest>> requests;
    std::map<LabelRequest::Kind, int> started;
    /// Of each request that was served: how many places.
    std::vector<std::size_t> sizes;
    backend::LabelListener* listener{nullptr};
    bool is_prompt{true};
    /// Requests that wait for an answer; more are refused.
    std::size_t room{SIZE_MAX};
    LabelStatus fault{LabelStatus::Done};
    LabelStatus sample_fault{LabelStatus::Done};
    DateTime time{1'000'000};
    std::vector<std::uint64_t> sample_offsets;
    std::vector<std::byte> scanned;
    std::uint64_t scan{0};
    DateTime scan_time{};
    std::uint64_t next_address{100};

private:
    void serve(LabelRequest& request)
    {
        request.time = time;
        request.status = fault;
        if (fault != LabelStatus::Done) {
            return;
        }
        sizes.push_back(request.places.size());
        switch (request.kind) {
        case LabelRequest::Kind::Resolve:
            for (const std::string& name : request.names) {
                const auto found = labels.find(name);
                request.labels.push_back(found == labels.end() ? ResolvedLabel{} : found->second);
            }
            break;
        case LabelRequest::Kind::Sample:
            request.status = sample_fault;
            for (const backend::LabelPlace& place : request.places) {
                sample_offsets.push_back(place.address);
            }
            break;
        default:
            access(request);
            break;
        }
    }
    void access(LabelRequest& request)
    {
        for (const backend::LabelPlace& place : request.places) {
            if (!memory.contains(place.address)) {
                request.status = LabelStatus::Mismatch;
                return;
            }
        }
        for (const backend::LabelPlace& place : request.places) {
            auto& bytes = memory.at(place.address);
            REQUIRE(bytes.size() == place.size);
            std::byte* const at = request.bytes.data() + place.offset;
            if (request.kind == LabelRequest::Kind::Read) {
                std::copy(bytes.begin(), bytes.end(), at);
            } else {
                std::copy(at, at + place.size, bytes.begin());
            }
        }
    }
};

} // namespace busbar::test
