#pragma once

#include <cstdint>
#include <mosquitto.h>
#include <string>
#if !__has_include(<mosquitto/mqtt_protocol.h>) // since 2.1 it comes with mosquitto.h
#include <mqtt_protocol.h>
#endif

namespace bris {

/// Properties of a packet of version 5.
class Properties {
public:
    Properties() = default;
    Properties(const Properties&) = delete;
    ~Properties() { mosquitto_property_free_all(&list_); }
    void add(int identifier, std::uint32_t value) {
        mosquitto_property_add_int32(&list_, identifier, value);
    }
    const mosquitto_property* get() const { return list_; }

private:
    mosquitto_property* list_ = nullptr;
};

/// Why a broker does not want this client, now or later: another try would have the same answer, or
/// would end the connection of somebody else. `code`: reason code of its CONNACK or DISCONNECT.
/// Empty: it may answer otherwise later.
std::string final_answer(int code);

/// The other broker that it names, as the end of a sentence; empty: none.
std::string other_broker(const mosquitto_property* properties);

} // namespace bris
