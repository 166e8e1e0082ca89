// The script of a page that has its stream and its sound in it, as base64 in two elements.
import './neuvv-player.js';

/** The address of what an element has; empty where that is nothing. */
function addressOf(id, type) {
    const element = document.getElementById(id), letters = atob(element.textContent);
    element.remove();  // it is large
    const bytes = new Uint8Array(letters.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
    return letters && URL.createObjectURL(new Blob([bytes], {type}));
}

const player = document.querySelector('neuvv-player');
player.setAttribute('sound', addressOf('sound', 'audio/mp4'));
player.src = addressOf('stream', 'application/octet-stream');
