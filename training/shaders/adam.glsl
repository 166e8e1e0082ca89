// Adam (Kingma and Ba 2015) for parameters that most steps do not touch: an element whose gradient is exactly 0 keeps
// its value and its moments. With adam.emit nothing moves, and the first moment becomes the gradient.
#ifndef NEUVV_ADAM_GLSL
#define NEUVV_ADAM_GLSL

struct AdamElement {
    vec4 weight, first, second;
};

AdamElement adam_update(AdamElement old, vec4 gradient, float rate, AdamPush adam) {
    const bvec4 touched = notEqual(gradient, vec4(0.0));
    AdamElement new = old;
    new.first = mix(old.first, adam.beta1 * old.first + (1.0 - adam.beta1) * gradient, touched);
    new.second = mix(old.second, adam.beta2 * old.second + (1.0 - adam.beta2) * gradient * gradient, touched);
    const vec4 move = rate * (new.first / adam.bias1) / (sqrt(new.second / adam.bias2) + adam.epsilon);
    new.weight = mix(old.weight, old.weight - move, touched);
    if (adam.emit != 0u) new = AdamElement(old.weight, gradient, old.second);
    return new;
}

#endif
